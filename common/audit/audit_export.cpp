#include "common/audit/audit_export.hpp"

#include <algorithm>
#include <iterator>
#include <map>
#include <utility>

#include "common/base/hex.hpp"
#include "proto/body.hpp"
#include "proto/make_shape.hpp"
#include "proto/value.hpp"

namespace trb {
namespace {

constexpr std::string_view kRecord = "record";
constexpr std::string_view kHash = "hash";
constexpr std::string_view kHead = "head";
constexpr std::string_view kCertificate = "certificate";

std::string line_of(std::string_view kind, const std::string& json, const std::string& more = "") {
  return "{\"" + std::string(kind) + "\":" + json + more + "}\n";
}

/// What an export contains, as it is: nothing is checked yet.
struct Lines {
  std::vector<AuditRow> rows;
  std::vector<SignedRecord> heads;
  std::vector<SignedRecord> certificates;
};

template <class T>
Result<T> member(const Value& line, std::string_view name) {
  const Value* found = line.find(name);
  if (found == nullptr) {
    std::string what(name);  // as one sum GCC 12 warns of it
    what += " is missing";
    return fail(Errc::missing, std::move(what), "export the log anew");
  }
  T out;
  if (Error error = read_json(make_shape<T>(), dump_json(*found), &out); error.code != Errc::ok) return error;
  return out;
}

Result<AuditRow> row_of(const Value& line) {
  auto record = member<AuditRecord>(line, kRecord);
  if (!record) return record.error();
  const Value* hash = line.find(kHash);
  auto bytes = from_hex(hash != nullptr && hash->is_text() ? hash->text() : "-");
  if (!bytes) return fail(Errc::malformed, "hash is not hexadecimal", "export the log anew");
  return AuditRow{std::move(*record), std::move(*bytes)};
}

Status take(const Value& line, Lines& out) {
  if (line.find(kRecord) != nullptr) {
    auto row = row_of(line);
    if (!row) return row.error();
    out.rows.push_back(std::move(*row));
    return Done{};
  }
  const bool is_head = line.find(kHead) != nullptr;
  auto record = member<SignedRecord>(line, is_head ? kHead : kCertificate);
  if (!record) return record.error();
  if (is_head) {
    out.heads.push_back(std::move(*record));
  } else {
    out.certificates.push_back(std::move(*record));
  }
  return Done{};
}

Result<Lines> lines_of(std::string_view text) {
  Lines out;
  for (std::size_t number = 1; !text.empty(); ++number) {
    const std::string_view line = text.substr(0, text.find('\n'));
    text.remove_prefix(std::min(text.size(), line.size() + 1));
    if (line.empty()) continue;
    const auto value = parse_json(line);
    const Status taken = value ? take(*value, out) : Status(value.error());
    if (!taken)
      return fail(Errc::malformed, "line " + std::to_string(number) + ": " + taken.error().what, taken.error().hint);
  }
  return out;
}

/// Cloud nodes, as only they have a gateway: what a robot's key has signed proves nothing. Of several certificates of
/// one the last counts.
using Signers = std::map<std::string, Certificate>;

/// The head, if one of the nodes has signed it.
std::optional<AuditHead> head_of(const SignedRecord& record, const Signers& signers, BytesView fleet) {
  const auto signed_it = [&](const auto& one) {
    return verify(record, kSignedAuditHead, fleet, one.second.identity_key.bytes);
  };
  if (std::ranges::none_of(signers, signed_it)) return std::nullopt;
  auto head = read_audit_head(record.payload.bytes);
  if (!head) return std::nullopt;
  return std::move(*head);
}

/// Whose chain it is: of several gateways that share one, the first has begun it.
std::string chain_node(const Lines& lines, const Signers& signers, const std::string& otherwise, BytesView fleet) {
  for (const auto& [node, certificate] : signers) {
    if (!lines.rows.empty() && audit_hash(audit_start(fleet, node), lines.rows[0].record) == lines.rows[0].hash)
      return node;
  }
  return otherwise;
}

}  // namespace

std::string audit_line(const AuditRow& row) {
  return line_of(kRecord, write_json(make_shape<AuditRecord>(), &row.record),
                 ",\"" + std::string(kHash) + "\":\"" + to_hex(row.hash) + "\"");
}

std::string audit_head_line(const SignedRecord& head) {
  return line_of(kHead, to_json(head));
}

std::string audit_certificate_line(const SignedRecord& certificate) {
  return line_of(kCertificate, to_json(certificate));
}

Result<AuditCheck> check_audit_export(std::string_view text, const FleetAuthority& authority) {
  auto lines = lines_of(text);
  if (!lines) return lines.error();
  Signers signers;
  std::string last;
  for (const SignedRecord& record : lines->certificates) {
    auto signer = open_certificate_any_time(record, authority);
    if (!signer) return signer.error();
    if (signer->role != Role::cloud) continue;
    last = signer->id;
    signers.insert_or_assign(last, std::move(*signer));
  }
  if (signers.empty()) {
    return fail(Errc::missing, "the export has no certificate of a cloud node",
                "export the log anew, from its first record on");
  }
  std::vector<AuditHead> heads;
  for (const SignedRecord& record : lines->heads) {
    if (auto head = head_of(record, signers, authority.id())) heads.push_back(std::move(*head));
  }
  const std::string node = chain_node(*lines, signers, last, authority.id());
  AuditCheck out{node, {}, lines->rows.size(), heads.size(), lines->heads.size() - heads.size()};
  out.report = verify_audit(audit_start(authority.id(), node), lines->rows, heads);
  return out;
}

Result<std::optional<AuditParting>> find_parting(std::string_view first, std::string_view second) {
  const auto left = lines_of(first);
  if (!left) return left.error();
  const auto right = lines_of(second);
  if (!right) return right.error();
  const auto [a, b] = std::ranges::mismatch(left->rows, right->rows);
  if (a == left->rows.end() || b == right->rows.end()) return std::optional<AuditParting>();
  return std::optional(AuditParting{a == left->rows.begin() ? 0 : std::prev(a)->record.number, a->record, b->record});
}

Result<std::vector<std::string>> join_exports(const std::vector<std::string>& files) {
  std::vector<std::string> out;
  std::uint64_t last = 0;
  for (const std::string& file : files) {
    const auto lines = lines_of(file);
    if (!lines) return lines.error();
    const bool is_another = !lines->rows.empty() && lines->rows.front().record.number <= last;
    if (out.empty() || is_another) out.emplace_back();
    out.back() += file;
    if (!file.ends_with('\n')) out.back() += '\n';
    if (!lines->rows.empty()) last = lines->rows.back().record.number;
  }
  return out;
}

}  // namespace trb
