#include "common/audit/audit_verify.hpp"

#include <map>

namespace trb {
namespace {

using Heads = std::multimap<std::uint64_t, const AuditHead*>;

class Verifier {
 public:
  Verifier(BytesView start, std::span<const AuditHead> heads) : start_(start), hash_(start) {
    for (const AuditHead& head : heads) heads_.emplace(head.number, &head);
  }

  AuditReport run(std::span<const AuditRow> rows) {
    if (check_starts() && check_heads_here()) {
      for (const AuditRow& row : rows)
        if (!take(row)) return report_;
      check_end();
    }
    return report_;
  }

 private:
  bool refuse(AuditFaultKind kind, std::uint64_t number, std::string what) {
    report_.fault = AuditFault{kind, number, std::move(what)};
    return false;
  }

  bool check_starts() {
    for (const auto& [number, head] : heads_) {
      if (head->start.bytes != start_)
        return refuse(AuditFaultKind::other_chain, 1, "a signed head is of another node's or fleet's audit");
    }
    return true;
  }

  bool take(const AuditRow& row) {
    const std::uint64_t expected = next_audit_number(report_.good, row.record);
    const std::uint64_t number = row.record.number;
    // A backup has no heads of what was recorded after it: who takes records out, and says "restored", has.
    if (const auto head = heads_.upper_bound(report_.good); head != heads_.end() && head->first < expected)
      return refuse(AuditFaultKind::missing, report_.good + 1,
                    "a signed head tells of record " + std::to_string(head->first));
    if (number > expected)
      return refuse(AuditFaultKind::missing, expected, "record " + std::to_string(number) + " stands in its place");
    if (number < expected)
      return refuse(AuditFaultKind::out_of_order, expected,
                    "record " + std::to_string(number) + " stands in its place");
    if (!is_canonical(row.record) || audit_hash(hash_, row.record) != row.hash)
      return refuse(AuditFaultKind::altered, number, "its hash is not that of the record and the one before");
    hash_ = row.hash;
    report_.good = number;
    if (row.record.action == kAuditRestored) report_.restored.push_back(row.record);
    return check_heads_here();
  }

  /// Checks the heads that were signed at this record.
  bool check_heads_here() {
    const auto [first, last] = heads_.equal_range(report_.good);
    for (auto at = first; at != last; ++at) {
      if (at->second->hash.bytes == hash_) continue;
      report_.good = report_.covered;
      return refuse(
          AuditFaultKind::other_head, report_.covered + 1,
          "a record from here to " + std::to_string(at->first) + " was changed, and all behind it hashed anew");
    }
    if (first != last) report_.covered = report_.good;
    return true;
  }

  void check_end() {
    if (heads_.empty() || heads_.rbegin()->first <= report_.good) return;
    refuse(AuditFaultKind::truncated, report_.good + 1,
           "it is not there, and a signed head tells of " + std::to_string(heads_.rbegin()->first) + " records");
  }

  BytesView start_;
  Bytes hash_;
  Heads heads_;
  AuditReport report_;
};

}  // namespace

AuditReport verify_audit(BytesView start, std::span<const AuditRow> rows, std::span<const AuditHead> heads) {
  return Verifier(start, heads).run(rows);
}

}  // namespace trb
