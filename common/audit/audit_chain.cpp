#include "common/audit/audit_chain.hpp"

#include <algorithm>

#include "common/security/keys.hpp"
#include "proto/body.hpp"
#include "proto/make_shape.hpp"
#include "proto/value.hpp"

namespace trb {
namespace {

/// Calls visit(text, bound) for each text of a record, by its field table.
template <class Record, class Visit>
void for_each_text(Record& record, const Visit& visit) {
  for (const FieldEntry& entry : AuditRecord::fields())
    if (entry.shape->kind == FieldKind::text) visit(as<std::string>(behind(&record, entry.offset)), entry.max);
}

}  // namespace

std::uint64_t next_audit_number(std::uint64_t last, const AuditRecord& record) {
  constexpr std::int64_t kMs = 1'000'000;
  const bool is_restored = record.action == kAuditRestored && record.time > 0;
  return std::max(last + 1, is_restored ? static_cast<std::uint64_t>(record.time / kMs) : 0);
}

Bytes audit_head_payload(const AuditHead& head) {
  return pack(make_shape<AuditHead>(), &head);
}

Result<AuditHead> read_audit_head(BytesView payload) {
  AuditHead out;
  if (Error error = unpack(make_shape<AuditHead>(), payload, &out); error.code != Errc::ok) return error;
  return out;
}

Bytes audit_start(BytesView fleet, std::string_view node) {
  Bytes all(fleet);
  all += node;
  return purpose_digest("gateway_audit_start", all);
}

Bytes audit_hash(BytesView previous, const AuditRecord& record) {
  Bytes all(previous);
  all += pack(make_shape<AuditRecord>(), &record);
  return purpose_digest("gateway_audit", all);
}

bool is_canonical(const AuditRecord& record) {
  bool out = true;
  for_each_text(
      record, [&](const std::string& text, std::uint32_t most) { out = out && text.size() <= most && is_utf8(text); });
  return out;
}

AuditChain::AuditChain(Bytes start) : start_(std::move(start)), hash_(start_) {}

AuditChain::AuditChain(Bytes start, const AuditRow& last)
    : start_(std::move(start)), hash_(last.hash), number_(last.record.number) {}

AuditRow AuditChain::append(AuditRecord record) {
  record.number = number_ = next_audit_number(number_, record);
  for_each_text(record, [](std::string& text, std::uint32_t most) {
    if (text.size() > most || !is_utf8(text)) text = cut_utf8(text, most);
  });
  hash_ = audit_hash(hash_, record);
  return {std::move(record), hash_};
}

AuditHead AuditChain::head(UtcTime now) const {
  return {{start_}, number_, {hash_}, now.ns};
}

}  // namespace trb
