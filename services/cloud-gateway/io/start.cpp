#include "services/cloud-gateway/io/start.hpp"

#include "common/base/files.hpp"
#include "common/config/cloud_file.hpp"
#include "common/log/log.hpp"
#include "common/security/node_keys.hpp"
#include "common/service/waiting.hpp"
#include "proto/body.hpp"
#include "services/cloud-gateway/io/api/once.hpp"
#include "services/cloud-gateway/io/http/tls_files.hpp"
#include "services/cloud-gateway/io/postgres_server.hpp"
#include "services/cloud-gateway/io/process.hpp"
#include "services/cloud-gateway/io/store/shared_db.hpp"
#include "services/cloud-gateway/io/store/shared_history.hpp"

namespace trb::gateway {
namespace {

/// A shared database that does not answer by then is waited for with 503.
constexpr Duration kFirstAnswer = std::chrono::seconds(3);

std::vector<std::string> certificate_names(const CloudSettings& settings) {
  std::vector<std::string> out{"localhost", "127.0.0.1"};
  if (settings.address != "127.0.0.1" && settings.address != "0.0.0.0" && settings.address != "::") {
    out.push_back(settings.address);
  }
  for (const std::string& name : settings.names) out.push_back(name.substr(0, name.find(':')));
  return out;
}

HttpServerSettings server_settings(const TlsFiles& files, const CloudSettings& cloud) {
  HttpServerSettings out;
  out.address = cloud.address;
  out.port = cloud.port;
  out.proxies = cloud.proxies;
  out.certificate_file = files.certificate;
  out.key_file = files.key;
  return out;
}

HistoryLimits limits_of(const CloudSettings& cloud) {
  return {std::chrono::hours(24) * cloud.history_days, std::uint64_t{cloud.history_mb} << 20U};
}

Result<std::unique_ptr<GatewayDb>> open_db(const NodeConfig& config, const CloudSettings& cloud,
                                           const NodeCertificate& keys) {
  if (!cloud.database) return GatewayDb::open(config.dir + "/state/gateway.db");
  auto server = postgres_server(*cloud.database, config.dir);
  if (!server) return server.error();
  return open_shared_db(std::move(*server), {config.id, encode(keys.record)}, kFirstAnswer);
}

Result<std::unique_ptr<HistoryStore>> open_history(const NodeConfig& config, const CloudSettings& cloud) {
  if (!cloud.database) return history_file(config.dir + "/state/history.db", limits_of(cloud));
  auto server = postgres_server(*cloud.database, config.dir);
  if (!server) return server.error();
  return open_shared_history(std::move(*server), config.id, limits_of(cloud), kFirstAnswer);
}

/// What another gateway is at work on is not settled here.
Result<std::unique_ptr<Access>> open_access(const NodeConfig& config, const CloudSettings& cloud,
                                            const NodeCertificate& keys, GatewayDb& db) {
  auto access = Access::open(db, cloud.origins(), {keys.authority.id(), config.id});
  if (!access || db.is_shared()) return access;
  (*access)->note_restored(now().utc);
  if (Status settled = settle_unsure(**access, now().utc); !settled) return settled.error();
  return access;
}

/// What a gateway keeps: an account's rights and their use, what was, who is signed in.
struct Stores {
  std::unique_ptr<GatewayDb> db;
  std::unique_ptr<HistoryStore> history;
  std::unique_ptr<Access> access;
};

Status open_stores(const NodeConfig& config, const CloudSettings& cloud, const NodeCertificate& keys, Stores& out) {
  if (auto made = make_private_dir(config.dir + "/state"); !made) return made;
  auto db = open_db(config, cloud, keys);
  if (!db) return db.error();
  auto history = open_history(config, cloud);
  if (!history) return history.error();
  auto access = open_access(config, cloud, keys, **db);
  if (!access) return access.error();
  out = {std::move(*db), std::move(*history), std::move(*access)};
  return Done{};
}

}  // namespace

Result<int> start(NodeConfig config) {
  init_crypto();
  ConfigFaults faults;  // reported by the check
  const CloudSettings cloud = read_cloud_file(config.dir, faults);
  const auto keys = load_node_certificate(config.dir);
  if (!keys) return keys.error();
  const ServiceOptions options{config.dir, "cloud-gateway", {}, FleetView::subscriptions()};
  Stores stores;
  const auto waited = wait_for_files(
      options, [&] { return open_stores(config, cloud, *keys, stores); }, Room::not_needed);
  if (!waited || *waited) return waited ? Result<int>(**waited) : waited.error();
  const auto files = provide_tls_files(config.dir, certificate_names(cloud), now().utc);
  if (!files) return files.error();
  const auto service = Service::open(options);
  if (!service) return service.error();
  Process process(**service, *stores.db, std::move(stores.history), *stores.access, config.dir,
                  std::move(config.places), files->ends);
  return process.run(server_settings(*files, cloud), cloud.origins());
}

}  // namespace trb::gateway
