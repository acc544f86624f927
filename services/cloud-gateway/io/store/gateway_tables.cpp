#include "services/cloud-gateway/io/store/gateway_tables.hpp"

#include "services/cloud-gateway/io/store/audit_rows.hpp"
#include "services/cloud-gateway/io/store/in_order.hpp"
#include "services/cloud-gateway/io/store/store_rows.hpp"

namespace trb::gateway {

Status GatewayTables::read(const StoreKinds& kinds, StoredState& out) {
  out.kinds = kinds;
  return in_order([&] { return read_state(*sql_, kinds, out); },
                  [&] { return kinds.contains(StoreKind::audit) ? read_end(*sql_, out) : Status(Done{}); });
}

Status GatewayTables::write(const StoreBatch& batch) {
  return in_order([&] { return write_state(*sql_, batch); }, [&] { return write_audit(*sql_, batch); });
}

Result<StoredState> GatewayTables::load() {
  StoredState out;
  // In one transaction: another gateway may write in between.
  if (Status done = sql_->transact([&] { return read(all_kinds(), out); }); !done) return done.error();
  return out;
}

Status GatewayTables::save(const StoreBatch& batch) {
  if (batch.empty()) return Done{};
  return sql_->transact([&] { return write(batch); });
}

Result<std::vector<AuditRow>> GatewayTables::audit(const AuditQuery& query) {
  return read_audit(*sql_, query);
}

Result<std::vector<AuditRow>> GatewayTables::audit_from(std::uint64_t number, std::size_t most) {
  return read_audit_from(*sql_, number, most);
}

Result<std::vector<SignedHead>> GatewayTables::heads(std::uint64_t first, std::uint64_t last) {
  return read_heads(*sql_, first, last);
}

}  // namespace trb::gateway
