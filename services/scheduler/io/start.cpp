#include "services/scheduler/io/start.hpp"

#include <cstdio>

#include "common/base/files.hpp"
#include "common/config/node_config.hpp"
#include "common/log/log.hpp"
#include "common/security/node_keys.hpp"
#include "common/service/service.hpp"
#include "services/scheduler/core/scheduler_core.hpp"
#include "services/scheduler/io/journal.hpp"

namespace trb::scheduler {
namespace {

int refuse(const std::string& text) {
  std::fprintf(stderr, "trb-scheduler: %s\n", text.c_str());
  return 1;
}

int run(const NodeConfig& node, const NodeKeys& keys, Service& service, JournalFile& journal) {
  SchedulerCore core({node.id, keys.authority, node.has_service("mode-adapter")}, journal);
  if (journal.was_lost()) {
    log_event(Level::error, "journal_lost",
              "state/journal.db is new, though this node had one: what it knew of its open runs is lost");
  }
  const auto records = journal.load();
  if (!records) return refuse(records.error().text());
  if (auto restored = core.restore(*records); !restored) {
    return refuse("state/journal.db: " + restored.error().text() +
                  "; move it away if this node's keys or fleet were changed on purpose, and abort its open runs");
  }
  service.on_journal([&](const std::vector<Journal>& step) { return journal.commit(step); });
  return service.run(core);
}

}  // namespace

int start(const std::string& node_dir) {
  init_crypto();
  const NodeCheck check = check_node_dir(node_dir, true);
  if (!faults_that_stop(check.faults).empty()) return refuse("nothing started\n" + to_text(check.faults));
  const auto keys = load_node_keys(check.config.dir);
  if (!keys) return refuse(keys.error().text());
  if (auto made = make_private_dir(check.config.dir + "/state"); !made) return refuse(made.error().text());
  auto journal =
      JournalFile::open(check.config.dir + "/state/journal.db", std::int64_t{check.config.archive_mb} << 20U);
  if (!journal) return refuse(journal.error().text());
  auto service = Service::open({check.config.dir, "scheduler", SchedulerCore::subtypes()});
  if (!service) return refuse(service.error().text());
  return run(check.config, *keys, **service, **journal);
}

}  // namespace trb::scheduler
