#include "services/cloud-gateway/io/store/gateway_db.hpp"

#include "services/cloud-gateway/io/store/gateway_schema.hpp"
#include "services/cloud-gateway/io/store/gateway_tables.hpp"

namespace trb::gateway {
namespace {

constexpr const char* kDamagedCure =
    "move it away together with its -wal and -shm files, and bring a copy back (state/gateway.db of what trb node "
    "restore "
    "makes of a backup in a new folder); without one, users are made anew and the audit log begins anew";
constexpr const char* kNewerCure =
    "start the build that wrote it; without it users, tokens and the audit log are lost, so keep a copy";

}  // namespace

StoreKinds all_kinds() {
  StoreKinds out;
  for (std::size_t i = 0; i < enum_names(StoreKind{}).size(); ++i) out.insert(static_cast<StoreKind>(i));
  return out;
}

bool StoreBatch::empty() const {
  return kinds().empty() && !steady;
}

StoreKinds StoreBatch::kinds() const {
  StoreKinds out;
  const auto add = [&](StoreKind kind, bool is_in) {
    if (is_in) out.insert(kind);
  };
  add(StoreKind::users, !users.empty());
  add(StoreKind::sessions, !sessions.empty());
  add(StoreKind::tokens, !tokens.empty());
  add(StoreKind::requests, !requests.empty() || !dropped_requests.empty() || !moved_requests.empty());
  add(StoreKind::scenarios, !scenarios.empty());
  add(StoreKind::acknowledged, !acknowledged.empty());
  add(StoreKind::shelves, !shelves.empty());
  add(StoreKind::audit, !audit.empty() || !heads.empty());
  return out;
}

Result<std::unique_ptr<GatewayDb>> GatewayDb::open(const std::string& path) {
  auto sql = open_sqlite(path, gateway_steps(), {kDamagedCure, kNewerCure});
  if (!sql) return sql.error();
  return std::unique_ptr<GatewayDb>(std::make_unique<GatewayTables>(std::move(*sql)));
}

}  // namespace trb::gateway
