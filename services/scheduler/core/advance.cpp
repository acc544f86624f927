// SchedulerCore: the end of every step: what follows from the facts and the time.
#include <algorithm>
#include <cstdio>
#include <limits>

#include "proto/value.hpp"
#include "services/scheduler/core/scheduler_core.hpp"
#include "services/scheduler/core/view.hpp"

namespace trb {

using namespace scheduler;

namespace {

/// Who has ended a task passes it on within seconds; the decider waits longer for it than a restart takes.
constexpr Duration kPassPatience = std::chrono::seconds(30);

}  // namespace

void SchedulerCore::advance(Step step) {
  if (!last_) return;  // not yet welcome: nothing can be sent
  last_ = step.now;
  last_steady_ = step.steady;
  keep_time(step);
  if (settings_.has_robot) {
    lost_.tick(settings_.node, step.now, step.out);
  } else {
    lost_.told(step.now, step.out);
  }
  end_runs(step);
  for (Run* run : runs_.runs()) {
    std::erase_if(run->retry_at, [&](const auto& one) { return one.second <= step.now.mono; });
    look_at(*run, step);
  }
  permit_attempt(step);
  executor_.tick(step.now, step.out);
  start_next(step);
  for (Run* run : runs_.runs()) {
    confirm_abort(*run, step);
    decide(*run, step);
    abort_on_failure(*run, step);
    hold_for_doubles(*run, step);
    ask_end(*run, step);
    pass_overdue(*run, step);
    pass_on(*run, step);
    ask_needs(*run, step);
  }
  for (const Inbound& message : deferred_.take_late(step.now.mono)) {
    refuse(message, fail(Errc::unknown_run, "its run's definition, or its decision, did not come"), step);
  }
  tell_watchers(step);
}

/// What of it is due, and since when; whom the decider passes on in whose place.
void SchedulerCore::look_at(Run& run, Step step) {
  if (run.held() || run.aborted() || run.ended()) run.due_at.clear();
  // That a task has begun is told by no fact of the run.
  std::erase_if(run.due_at, [&](const auto& one) { return run.progress.contains(one.first) || runs(run, one.first); });
  const std::uint64_t version = run.version() + run.deliveries.changes();
  if (run.looked_version == version) return;
  run.looked_version = version;
  const auto keep = [&](std::map<TaskIndex, MonotonicTime>& times, std::vector<TaskIndex> tasks, MonotonicTime at) {
    std::ranges::sort(tasks);
    std::erase_if(times, [&](const auto& one) { return !std::ranges::binary_search(tasks, one.first); });
    for (const TaskIndex task : tasks) times.try_emplace(task, at);
  };
  keep(run.pass_at, run.unpassed(), step.now.mono + kPassPatience);
  if (run.held() || run.aborted() || run.ended()) return;
  std::vector<TaskIndex> due = run.due();
  if (executor_.runs(run.id())) {
    const TaskIndex task = *run.index_of(executor_.attempt()->execute.key.task);
    if (!runs(run, task)) due.push_back(task);
  }
  keep(run.due_at, std::move(due), step.now.mono);
}

/// This node's robot does it, or has done it.
bool SchedulerCore::runs(const Run& run, TaskIndex task) const {
  if (!executor_.runs(run.id()) || executor_.attempt()->execute.key.task != run.tasks()[task].id) return false;
  const Phase phase = executor_.attempt()->phase;
  return phase == Phase::running || phase == Phase::signing;
}

/// The task was due for longer than its scenario lets it wait.
bool SchedulerCore::is_late(const Run& run, TaskIndex task, Step step) const {
  const double within_s = run.tasks()[task].start_within_s;
  const auto due = run.due_at.find(task);
  return within_s > 0 && due != run.due_at.end() && due->second + seconds(within_s) <= step.now.mono;
}

std::string SchedulerCore::late_text(const Run& run, TaskIndex task) const {
  const std::string why = executor_.obstacle(run.tasks()[task].skill);
  char within[32];
  std::snprintf(within, sizeof within, "%g s", run.tasks()[task].start_within_s);
  return "it did not begin within " + std::string(within) + (why.empty() ? "" : ": " + why);
}

void SchedulerCore::permit_attempt(Step step) {
  if (!executor_.attempt()) return;
  const Run* run = runs_.find(executor_.attempt()->execute.key.run);
  if (run == nullptr) return;
  const AttemptKey& key = executor_.attempt()->execute.key;
  const TaskIndex task = *run->index_of(key.task);
  if (run->aborted()) return executor_.allow(Permit::cancel, "the run is aborted");
  if (run->ended()) return executor_.allow(Permit::cancel, "the run has FINISHED");
  if (run->is_void(task, key.attempt)) {
    const std::string why = "epoch " + std::to_string(run->epoch()) + ": the task is for '" + run->robot_of(task) + "'";
    return executor_.allow(Permit::cancel, why + " now");
  }
  if (run->expired(step.steady)) return executor_.allow(Permit::no_more, "the run has expired");
  if (run->asked_back.contains(task)) {
    return executor_.allow(Permit::give_back, "given back to '" + run->decider() + "', never begun");
  }
  if (run->held()) return executor_.allow(Permit::hold, "the run is held");
  if (executor_.is_refused() && is_late(*run, task, step)) {
    return executor_.allow(Permit::too_late, late_text(*run, task));
  }
  if (executor_.attempt()->permit != Permit::too_late) executor_.allow(Permit::go, {});
}

bool SchedulerCore::may_start(const Run& run, UtcTime steady) const {
  return !run.aborted() && !run.ended() && !run.expired(steady) && !run.held() && !run.has_new_double();
}

void SchedulerCore::resume_attempt() {
  if (executor_.attempt()) return;
  for (const Run* run : runs_.runs()) {
    if (const JournalStart* open = run->open_start()) return executor_.resume(run->attempt_for(*open));
  }
}

/// The higher priority first; of two alike the one whose task this robot began longest ago, so that no run starves the
/// younger ones; then the older.
std::vector<scheduler::Run*> SchedulerCore::by_turn() const {
  std::vector<Run*> out = runs_.runs();
  constexpr MonotonicTime kNever{std::numeric_limits<std::int64_t>::min()};
  const auto turn = [&](const Run* run) {
    return std::pair(kMaxPriority - run->start().priority, run->served.value_or(kNever));
  };
  std::ranges::stable_sort(out, {}, turn);
  return out;
}

void SchedulerCore::start_next(Step step) {
  executor_.want_adapter(false);
  if (!settings_.has_robot) return;
  resume_attempt();
  if (executor_.attempt() || lost_.open()) return;
  for (Run* run : by_turn()) {
    if (!may_start(*run, step.steady)) continue;
    for (const TaskIndex task : run->startable()) {
      if (run->retry_at.contains(task)) continue;
      if (executor_.obstacle(run->tasks()[task].skill).empty()) return start(*run, task, step);
      executor_.want_adapter(true);
      if (is_late(*run, task, step)) run->unbegun[task] = late_text(*run, task);  // and fails with it, by decide()
    }
  }
}

void SchedulerCore::start(Run& run, TaskIndex task, Step step) {
  if (const auto data = run.data_for(task); !data) {
    run.unbegun[task] = data.error().text();  // and fails with it, by decide()
    return;
  }
  JournalStart fact;
  fact.key = {run.id(), run.tasks()[task].id, 1, run.next_attempt(task)};
  fact.epoch = run.epoch();
  fact.instance = executor_.adapter()->instance;
  fact.time = step.now.utc.ns;
  step.out.record(fact);
  if (auto applied = run.apply(fact); !applied)
    return step.out.log(LogLevel::error, "not_started", applied.error().text());
  run.served = step.now.mono;
  executor_.begin(run.attempt_for(fact), step.now, step.out);
  tell_progress(run, fact.key, TaskState::initializing, step);
}

void SchedulerCore::tell_progress(const Run& run, const AttemptKey& key, TaskState state, Step step) {
  for (const std::string& cloud : run.clouds())
    step.out.information(cloud, TaskProgress{key, settings_.node, state, {}});
}

}  // namespace trb
