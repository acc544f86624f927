#include "services/cloud-gateway/io/start.hpp"

#include "common/base/files.hpp"
#include "common/config/cloud_file.hpp"
#include "common/log/log.hpp"
#include "common/security/node_keys.hpp"
#include "services/cloud-gateway/io/api/once.hpp"
#include "services/cloud-gateway/io/http/tls_files.hpp"
#include "services/cloud-gateway/io/process.hpp"

namespace trb::gateway {
namespace {

std::vector<std::string> certificate_names(const CloudSettings& settings) {
  std::vector<std::string> out{"localhost", "127.0.0.1"};
  if (settings.address != "127.0.0.1" && settings.address != "0.0.0.0" && settings.address != "::") {
    out.push_back(settings.address);
  }
  out.insert(out.end(), settings.names.begin(), settings.names.end());
  return out;
}

Result<HttpServerSettings> server_settings(const NodeConfig& config, const CloudSettings& cloud) {
  const auto files = provide_tls_files(config.dir, certificate_names(cloud), now().utc);
  if (!files) return files.error();
  HttpServerSettings out;
  out.address = cloud.address;
  out.port = cloud.port;
  out.certificate_file = files->certificate;
  out.key_file = files->key;
  return out;
}

HistoryLimits limits_of(const CloudSettings& cloud) {
  return {std::chrono::hours(24) * cloud.history_days, std::uint64_t{cloud.history_mb} << 20U};
}

Result<std::unique_ptr<Access>> open_access(const NodeConfig& config, const CloudSettings& cloud, GatewayDb& db) {
  const auto keys = load_node_keys(config.dir);
  if (!keys) return keys.error();
  auto access = Access::open(db, cloud.origins(), audit_start(keys->authority.id(), config.id));
  if (!access) return access.error();
  if (Status settled = settle_unsure(**access); !settled) return settled.error();
  return access;
}

}  // namespace

Result<int> start(NodeConfig config) {
  init_crypto();
  ConfigFaults faults;  // reported by the check
  const CloudSettings cloud = read_cloud_file(config.dir, faults);
  if (auto made = make_private_dir(config.dir + "/state"); !made) return made.error();
  const auto db = GatewayDb::open(config.dir + "/state/gateway.db");
  if (!db) return db.error();
  auto history = open_history_file(config.dir + "/state/history.db", limits_of(cloud));
  if (!history) return history.error();
  const auto access = open_access(config, cloud, **db);
  if (!access) return access.error();
  const auto server = server_settings(config, cloud);
  if (!server) return server.error();
  const auto service = Service::open({config.dir, "cloud-gateway", {}, FleetView::hears()});
  if (!service) return service.error();
  Process process(**service, **db, std::move(*history), **access, config.dir, std::move(config.places));
  return process.run(*server, cloud.origins());
}

}  // namespace trb::gateway
