// SchedulerCore: how runs end, and go to the archive.
#include <algorithm>

#include "services/scheduler/core/scheduler_core.hpp"
#include "services/scheduler/core/view.hpp"

namespace trb {

using namespace scheduler;

namespace {

/// What comes once more from those that have not heard yet is answered as before.
constexpr Duration kGrace = std::chrono::seconds(60);
constexpr Duration kKeepTime = std::chrono::minutes(10);

}  // namespace

/// After a loss of power the time goes on from here.
void SchedulerCore::keep_time(Step step) {
  if (runs_.runs().empty() || (keep_time_at_ && *keep_time_at_ > step.now.mono)) return;
  keep_time_at_ = step.now.mono + kKeepTime;
  step.out.record(JournalTime{step.steady.ns});
}

/// The judge says that it has FINISHED; who has nothing left to do asks it now and then.
void SchedulerCore::ask_end(Run& run, Step step) {
  const bool open = !run.aborted() && !run.ended() && !run.expired(step.steady);
  if (run.judge() != settings_.node) {
    if (!open || !run.is_idle() || executor_.runs(run.id())) return run.need_end.reset();
    if (run.need_end.due(step.now.mono)) step.out.request(run.judge(), NeedEnd{run.id()});
    return;
  }
  if (!open || !run.all_final() || run.has_new_double() || run.held_for_doubles()) return run.end_signature.reset();
  if (!run.end_signature) {
    const RunEnd end{run.id(), run.start().digest, settings_.node, RunState::finished, step.now.utc.ns};
    run.end_signature = Signature{std::string(kSignedRunEnd), encode(end), step.now.mono};
  }
  run.end_signature->tick(settings_.node, step.now, step.out);
}

void SchedulerCore::end_runs(Step step) {
  const std::vector<Run*> runs = runs_.runs();  // a copy: what is over leaves it
  for (Run* run : runs) {
    if (run->expired(step.steady)) {
      run->deliveries.drop(DeliveryKind::baton);
      run->needs.clear();
    }
    if (!is_over(*run, step)) {
      run->over_at.reset();
      continue;
    }
    if (!run->over_at) run->over_at = step.now.mono + (run->expired(step.steady) ? Duration{0} : kGrace);
    if (*run->over_at <= step.now.mono) put_into_archive(*run, step);
  }
}

/// Nothing is left to be done or told of it. What is owed of a run that has expired is owed a day longer.
bool SchedulerCore::is_over(const Run& run, Step step) const {
  if (executor_.runs(run.id())) return false;
  if (run.expired(step.steady)) return run.deliveries.empty() || step.steady >= run.buried_until();
  if (!run.deliveries.empty()) return false;
  if (run.aborted()) return true;
  // A second cloud node waits for the results that are still on their way to it.
  return run.ended() && (settings_.has_robot || run.judge() == settings_.node || run.all_final());
}

void SchedulerCore::put_into_archive(Run& run, Step step) {
  JournalArchive fact;
  fact.view = view_of(run, executor_, step.clock());
  fact.view.over = step.now.utc.ns;
  for (const TaskIndex task : run.results().tasks()) {
    fact.results.push_back(run.results().of(task)->record);
    const HeldChoice* choice = run.choice_on(task);
    const bool is_new = choice != nullptr && std::ranges::find(fact.choices, choice->record) == fact.choices.end();
    if (is_new) fact.choices.push_back(choice->record);
  }
  fact.decisions = run.decision_records();
  fact.orders = run.orders();
  if (run.end()) fact.end = *run.end();
  fact.until = run.buried_until().ns;
  step.out.log(LogLevel::info, "run_over", "run " + run.id() + ": " + std::string(name_of(fact.view.state)));
  RunSummary last = summary_of(run, executor_, step.clock());
  last.over = fact.view.over;
  watchers_.leave(last, step.out);
  const std::string id = run.id();
  step.out.record(std::move(fact));
  runs_.remove(id);
}

}  // namespace trb
