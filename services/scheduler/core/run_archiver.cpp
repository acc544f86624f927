#include "services/scheduler/core/run_archiver.hpp"

#include "services/scheduler/core/signed_records.hpp"
#include "services/scheduler/core/view.hpp"

namespace trb::scheduler {
namespace {

/// What comes once more from those that do not know it yet is answered as before.
constexpr Duration kGrace = std::chrono::seconds(60);

JournalArchive record_of(const Run& run, const RunStore& runs, const Executor& executor, Step step) {
  JournalArchive fact;
  fact.view = view_of(run, runs, executor, step.clock());
  fact.view.over = step.now.utc.ns;
  put_signed_records(run, fact);
  fact.until = run.definition().buried_until().ns;
  return fact;
}

}  // namespace

void RunArchiver::archive_if_over(Run& run, Step step) {
  const bool expired = run.definition().expired(step.steady);
  if (expired) {
    run.deliveries().pending().drop(DeliveryKind::baton);
    run.work().awaited().drop_results();
  }
  if (!is_over(run, step)) {
    run.work().stay();
  } else if (run.work().may_leave(step.now.mono, expired ? Duration{0} : kGrace)) {
    archive(run, step);
  }
}

/// Nothing is left to be done or sent for it. What is owed of a run that has expired is owed a day longer.
bool RunArchiver::is_over(const Run& run, Step step) const {
  if (executor_.runs(run.id())) return false;
  const bool owes = !run.deliveries().pending().empty();
  if (run.definition().expired(step.steady)) return !owes || step.steady >= run.definition().buried_until();
  if (owes) return false;
  if (run.orders().is_aborted()) return true;
  // A second cloud node waits for the results that are still on their way to it.
  return run.orders().has_ended() && (has_robot_ || run.epochs().judges_here() || run.facts().all_final());
}

void RunArchiver::archive(Run& run, Step step) {
  JournalArchive fact = record_of(run, runs_, executor_, step);
  step.out.log(LogLevel::info, "run_over", "run " + run.id() + ": " + std::string(name_of(fact.view.state)));
  RunSummary last = summary_of(run, runs_, executor_, step.clock());
  last.over = fact.view.over;
  watchers_.leave(last, step.out);
  const std::string id = run.id();  // NOLINT(performance-unnecessary-copy-initialization): the run goes
  step.out.record(std::move(fact));
  runs_.remove(id);
}

}  // namespace trb::scheduler
