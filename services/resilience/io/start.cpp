#include "services/resilience/io/start.hpp"

#include "common/base/files.hpp"
#include "common/config/node_config.hpp"
#include "common/log/log.hpp"
#include "common/service/service.hpp"
#include "common/service/waiting.hpp"
#include "services/resilience/io/recording_core.hpp"
#include "services/resilience/io/store.hpp"

namespace trb::resilience {
namespace {

CoreSettings settings_of(const NodeConfig& config) {
  ConfigFaults faults;  // reported by the check
  CoreSettings out{config.id, config.role, read_resilience_file(config.dir, faults), {}};
  for (const auto& [name, pose] : config.places) out.places[name] = {pose.x, pose.y};
  return out;
}

Status open_db(const NodeConfig& config, std::unique_ptr<CapabilityDb>& db) {
  if (auto made = make_private_dir(config.dir + "/state"); !made) return made;
  auto opened = CapabilityDb::open(config.dir + "/state/capability.db");
  if (!opened) return opened.error();
  db = std::move(*opened);
  return Done{};
}

}  // namespace

Result<int> start(NodeConfig config) {
  const ServiceOptions options{config.dir, "resilience", ResilienceCore::Taken::subtypes(),
                               ResilienceCore::subscriptions()};
  std::unique_ptr<CapabilityDb> db;
  const auto waited = wait_for_files(options, [&] { return open_db(config, db); });
  if (!waited || *waited) return waited ? Result<int>(**waited) : waited.error();
  ResilienceCore core(settings_of(config), db.get());
  if (Status restored = restore(*db, core); !restored) return restored.error();
  auto service = Service::open(options);
  if (!service) return service.error();
  RecordingCore recording(core, *db);
  (*service)->on_journal([&](const std::vector<Journal>& records) { return commit(*db, records); });
  const int status = (*service)->run(recording);
  if (Status written = recording.flush(now()); !written) {
    log_event(Level::error, "fleet_not_written", written.error().text());
  }
  return status;
}

}  // namespace trb::resilience
