// audit, its export, audit/head.
#include "common/audit/audit_export.hpp"
#include "common/base/hex.hpp"
#include "common/security/node_keys.hpp"
#include "proto/body.hpp"
#include "services/cloud-gateway/io/api/api.hpp"
#include "services/cloud-gateway/io/json_text.hpp"

namespace trb::gateway {
namespace {

constexpr std::uint64_t kMaxAuditPage = 1000;
constexpr std::size_t kExportPage = 5000;  ///< some 2 MB

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

/// Of all nodes whose gateways have written it, this one's last: a reader takes that one's chain if there is one alone.
Result<std::string> certificate_lines(Gateway& gateway, const SignedRecord& own) {
  const auto others = gateway.db.certificates();
  if (!others) return others.error();
  std::string out;
  for (const Bytes& bytes : *others) {
    const auto certificate = decode<SignedRecord>(bytes);
    if (!certificate) return certificate.error();
    if (*certificate != own) out += audit_certificate_line(*certificate);
  }
  return out + audit_certificate_line(own);
}

/// The lines of a page: the certificates, then the records with the heads that cover them.
Result<std::string> export_lines(Gateway& gateway, const std::vector<AuditRow>& rows) {
  const auto keys = load_node_certificate(gateway.node_dir);
  if (!keys) return keys.error();
  auto lines = certificate_lines(gateway, keys->record);
  if (!lines) return lines.error();
  std::string out = std::move(*lines);
  for (const AuditRow& row : rows) out += audit_line(row);
  if (rows.empty()) return out;
  const auto heads = gateway.db.heads(rows.front().record.number, rows.back().record.number);
  if (!heads) return heads.error();
  for (const SignedHead& head : *heads) {
    const auto record = decode<SignedRecord>(head.record);
    if (!record) return record.error();
    out += audit_head_line(*record);
  }
  return out;
}

/// For `trb audit verify`: from record `?from=` on, oldest first; the header Link names the next page, if there is one.
void export_audit(Gateway& gateway, const CallPtr& call) {
  const auto from = call->query_number("from", 1, std::numeric_limits<std::int64_t>::max());
  if (!from) return call->fail(from.error());
  const auto rows = gateway.db.audit_from(*from, kExportPage);
  if (!rows) return call->fail(rows.error());
  auto lines = export_lines(gateway, *rows);
  if (!lines) return call->fail(lines.error());
  HttpReply out;
  out.content_type = "application/x-ndjson";
  out.body = std::make_shared<const Bytes>(std::move(*lines));
  if (rows->size() == kExportPage) {
    const std::string next = std::to_string(rows->back().record.number + 1);
    out.headers.emplace_back("Link", "</api/v1/audit/export?from=" + next + ">; rel=\"next\"");
  }
  call->reply(std::move(out));
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
  table.add(Method::get, "/api/v1/audit/export", [&](const CallPtr& call) { export_audit(gateway, call); });
  table.add(Method::get, "/api/v1/audit/head", [&](const CallPtr& call) { show_head(gateway, call); });
}

}  // namespace trb::gateway
