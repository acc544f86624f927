#include "services/scheduler/io/start.hpp"

#include "common/base/files.hpp"
#include "common/config/node_config.hpp"
#include "common/log/log.hpp"
#include "common/security/node_keys.hpp"
#include "common/service/service.hpp"
#include "common/service/waiting.hpp"
#include "services/scheduler/core/scheduler_core.hpp"
#include "services/scheduler/io/journal.hpp"

namespace trb::scheduler {
namespace {

Result<int> run(const NodeConfig& node, const NodeCertificate& keys, Service& service, JournalFile& journal) {
  SchedulerCore core({node.id, keys.authority, node.has_service("mode-adapter"), keys.certificate.identity_key.bytes},
                     journal);
  if (journal.was_lost()) {
    log_event(Level::error, "journal_lost",
              "state/journal.db is new, though this node had one: what it knew of its open runs is lost");
  }
  const auto records = journal.load();
  if (!records) return records.error();
  if (auto restored = core.restore(*records); !restored) {
    return fail(restored.error().code, "state/journal.db: " + restored.error().what,
                "move it away if this node's keys or fleet were changed on purpose, and abort its open runs");
  }
  service.on_journal([&](const std::vector<Journal>& step) { return journal.commit(step); });
  return service.run(core);
}

Status open_journal(const NodeConfig& node, std::unique_ptr<JournalFile>& journal) {
  if (auto made = make_private_dir(node.dir + "/state"); !made) return made;
  auto opened = JournalFile::open(node.dir + "/state/journal.db", std::int64_t{node.archive_mb} << 20U);
  if (!opened) return opened.error();
  journal = std::move(*opened);
  return Done{};
}

}  // namespace

Result<int> start(NodeConfig node) {
  const auto keys = load_node_certificate(node.dir);
  if (!keys) return keys.error();
  const ServiceOptions options{node.dir, "scheduler", SchedulerCore::Taken::subtypes(), SchedulerCore::subscriptions()};
  std::unique_ptr<JournalFile> journal;
  const auto waited = wait_for_files(options, [&] { return open_journal(node, journal); });
  if (!waited || *waited) return waited ? Result<int>(**waited) : waited.error();
  auto service = Service::open(options);
  if (!service) return service.error();
  return run(node, *keys, **service, *journal);
}

}  // namespace trb::scheduler
