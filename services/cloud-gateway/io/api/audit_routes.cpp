// audit, audit/head.
#include "common/base/hex.hpp"
#include "services/cloud-gateway/io/api/api.hpp"
#include "services/cloud-gateway/io/json_text.hpp"

namespace trb::gateway {
namespace {

constexpr std::uint64_t kMaxAuditPage = 1000;

std::string json_audit(const AuditRow& row) {
  const AuditRecord& record = row.record;
  JsonObject out;
  out.number("number", record.number).time("time", UtcTime{record.time}).text("who", record.who);
  out.text("from", record.from).text("action", record.action).text("about", record.about);
  return out.text("outcome", record.outcome).text("hash", to_hex(row.hash)).done();
}

/// The newest first; `?before=` a number, `?limit=`, `?who=`.
void list_audit(Gateway& gateway, const CallPtr& call) {
  const auto before = call->query_number("before", 0, std::numeric_limits<std::int64_t>::max());
  if (!before) return call->fail(before.error());
  const auto limit = call->query_number("limit", 100, kMaxAuditPage);
  if (!limit) return call->fail(limit.error());
  AuditQuery query;
  if (*before > 0) query.before = *before;
  query.most = static_cast<std::size_t>(std::max<std::uint64_t>(*limit, 1));
  query.who = call->query("who");
  const auto rows = gateway.db.audit(query);
  if (!rows) return call->fail(rows.error());
  JsonList records;
  for (const AuditRow& row : *rows) records.add(json_audit(row));
  call->reply(json_reply(JsonObject().raw("records", records.done()).done()));
}

void show_head(const Gateway& gateway, const CallPtr& call) {
  const AuditHead head = gateway.access.chain.head(gateway.now().utc);
  JsonObject out;
  out.number("number", head.number).text("hash", to_hex(head.hash.bytes));
  call->reply(json_reply(out.number("signed_to", gateway.access.heads.covered()).done()));
}

}  // namespace

void add_audit_routes(Gateway& gateway, HandlerTable& table) {
  table.add(Method::get, "/api/v1/audit", [&](const CallPtr& call) { list_audit(gateway, call); });
  table.add(Method::get, "/api/v1/audit/head", [&](const CallPtr& call) { show_head(gateway, call); });
}

}  // namespace trb::gateway
