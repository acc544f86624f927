#include "services/scheduler/core/robot_schedule.hpp"

#include <algorithm>
#include <limits>

#include "common/scenario/values.hpp"
#include "proto/value.hpp"
#include "services/scheduler/core/late_binding.hpp"
#include "services/scheduler/core/refusal.hpp"
#include "services/scheduler/core/result_room.hpp"

namespace trb::scheduler {
namespace {

/// Who has ended a task passes it on within seconds; the decider waits longer for it than a restart takes.
constexpr Duration kPassPatience = std::chrono::seconds(30);
constexpr std::size_t kMaxWait = 512;  ///< of TaskProgress

/// The task's data, with the values that earlier results give. Errors: those of fill_values.
Result<std::string> data_for(const Run& run, TaskIndex task) {
  return fill_values(run.tasks()[task], [&](const std::string& name) -> const TaskResult* {
    const auto before = run.index_of(name);
    return before && run.results().has_final(*before) ? &run.results().of(*before)->result : nullptr;
  });
}

/// The attempt that a start record is for.
Attempt attempt_for(const RunStore& runs, const Run& run, const JournalStart& fact) {
  const TaskIndex index = *run.index_of(fact.key.task);
  const Task& task = run.tasks()[index];
  const auto data = data_for(run, index);
  const std::uint32_t first = std::min(run.epochs().first_attempt(index), fact.key.attempt);
  Attempt attempt;
  attempt.execute = {fact.key, fact.epoch, fact.instance, task.skill, data ? *data : task.data, task.timeout_s};
  attempt.may_retry = fact.key.attempt - first < task.retries && fact.key.attempt < kMaxAttempts;
  attempt.on_failure = task.on_failure;
  const std::size_t besides = bytes_besides(run);
  const std::string& self = run.epochs().self();
  const auto left_of = [&](std::size_t most) { return most - std::min(run.results().bytes_of(self) + besides, most); };
  // The other members leave room for no more.
  const std::size_t share = runs.bytes_left(self);
  const std::size_t left = std::max(left_of(free_bytes(run, self)), share - std::min(besides, share));
  attempt.most_data = std::min(left_of(ResultSet::kMostBytes), left);
  attempt.result.key = fact.key;
  attempt.result.digest = run.definition().start().digest;
  attempt.result.epoch = fact.epoch;
  attempt.result.robot = run.epochs().self();
  attempt.result.started = fact.time;
  return attempt;
}

}  // namespace

void notify_progress(const Run& run, const AttemptKey& key, TaskState state, const std::string& wait, Step step) {
  const std::string& self = run.epochs().self();
  for (const std::string& cloud : run.members().clouds_without(self)) {
    step.out.information(cloud, TaskProgress{key, self, state, wait});
  }
}

void RobotSchedule::resume_attempt() {
  if (executor_.attempt()) return;
  for (const Run* run : runs_.runs()) {
    if (run->work().has_given_up_attempt()) continue;
    if (const JournalStart* open = run->facts().open_start()) return executor_.resume(attempt_for(runs_, *run, *open));
  }
}

bool RobotSchedule::has_other_keys(const Run& run) const {
  const Certificate* own = run.members().find(run.epochs().self());
  return !identity_key_.empty() && own != nullptr && own->identity_key.bytes != identity_key_;
}

bool RobotSchedule::is_doing(const Run& run, TaskIndex task) const {
  if (!executor_.runs(run.id()) || executor_.attempt()->execute.key.task != run.tasks()[task].id) return false;
  const Phase phase = executor_.attempt()->phase;
  return phase == Phase::running || phase == Phase::signing;
}

void RobotSchedule::update_due(Run& run, Step step) const {
  TaskTimers& timers = run.work().timers();
  timers.drop_past_retries(step.now.mono);
  const bool goes_on = run.orders().goes_on() && !run.is_recovering();
  if (!goes_on) timers.drop_all_due();
  // No fact of the run says that a task has begun.
  timers.drop_due_if([&](TaskIndex task) { return run.reports().is_under_way(task) || is_doing(run, task); });
  if (!timers.take_version(run.timers_version())) return;
  const bool has_to_sign = run.orders().is_open() && !run.open_tasks().own_are_final();
  if (has_to_sign && has_other_keys(run)) withhold_unsigned(run, step);
  std::vector<TaskIndex> unpassed;
  if (goes_on) unpassed = run.deliveries().unpassed();
  timers.set_passes(std::move(unpassed), step.now.mono + kPassPatience);
  if (!goes_on) return;
  std::vector<TaskIndex> due = run.open_tasks().due();
  if (executor_.runs(run.id())) {
    const TaskIndex task = *run.index_of(executor_.attempt()->execute.key.task);
    if (!is_doing(run, task)) due.push_back(task);
  }
  timers.set_due(std::move(due), step.now.mono);
  std::vector<TaskIndex> unbound = run.epochs().own_tasks();
  std::erase_if(unbound, [&](TaskIndex task) { return !run.facts().wants_robot(task); });
  timers.set_unbound(std::move(unbound), step.now.mono);
}

bool RobotSchedule::is_late(const Run& run, TaskIndex task, Step step) {
  return run.work().timers().is_late(task, run.tasks()[task].start_within_s, step.now.mono);
}

std::string RobotSchedule::late_text(const Run& run, TaskIndex task) const {
  std::string why = executor_.obstacle(run.tasks()[task].skill);
  if (executor_.attempt()) {
    const AttemptKey& key = executor_.attempt()->execute.key;
    const bool other = key.run != run.id() || key.task != run.tasks()[task].id;
    if (other) why = "the robot was at task '" + key.task + "' of run " + key.run;
  }
  return "it did not begin within " + within_text(run, task) + (why.empty() ? "" : ": " + why);
}

void RobotSchedule::fail_late(Run& run, Step step) const {
  if (lost_.open() || !run.may_start(step.steady)) return;
  for (const TaskIndex task : run.open_tasks().startable()) {
    if (!is_late(run, task, step) || !is_surely_new(run, task, step.now.utc)) continue;
    run.work().withheld().fail(task, late_text(run, task));
  }
}

void RobotSchedule::resume_pauses(Run& run, Step step) {
  for (std::size_t i = 0; i < run.tasks().size(); ++i) {
    const auto task = static_cast<TaskIndex>(i);
    if (!run.epochs().is_own(task)) run.await_retry(task, step.now.mono, step.steady);
  }
}

std::optional<MonotonicTime> RobotSchedule::next_late(const Run& run, MonotonicTime now) {
  std::optional<MonotonicTime> out;
  for (const auto& [task, since] : run.work().timers().due_since()) {
    const double within_s = run.tasks()[task].start_within_s;
    const MonotonicTime late = since + seconds(within_s);
    if (within_s > 0 && run.epochs().is_own(task) && late > now) out = earlier(out, late);
  }
  return out;
}

void RobotSchedule::permit_attempt(Step step) {
  if (!executor_.attempt()) return;
  const AttemptKey& key = executor_.attempt()->execute.key;
  const Run* run = runs_.find(key.run);
  if (run == nullptr) return;
  const Allowed now = allowed(*run, key, step);
  // Who was too late once stays so.
  if (now.permit == Permit::go && executor_.attempt()->permit == Permit::too_late) return;
  executor_.allow(now.permit, now.why);
}

RobotSchedule::Allowed RobotSchedule::allowed(const Run& run, const AttemptKey& key, Step step) const {
  const TaskIndex task = *run.index_of(key.task);
  if (run.orders().is_aborted()) return {Permit::cancel, "the run is aborted"};
  if (run.orders().has_ended()) return {Permit::cancel, "the run has FINISHED"};
  if (run.epochs().is_void(task, key.attempt)) {
    return {Permit::cancel, "epoch " + std::to_string(run.epochs().current()) + ": the task is for '" +
                                run.epochs().robot_of(task) + "' now"};
  }
  if (run.definition().expired(step.steady)) return {Permit::no_more, "the run has expired"};
  const std::string& decider = run.definition().rule().decider();
  if (run.work().withheld().is_to_stop(task)) {
    return {Permit::stop, "asked back by '" + decider + "': somebody says that the robot stands"};
  }
  if (run.work().withheld().is_asked_back(task)) {
    return {Permit::give_back, "given back to '" + decider + "', never begun"};
  }
  // What the robot does may end; what its mode-adapter does not know must not begin: it may have ended long ago.
  if (run.work().withheld().are_all()) return {Permit::no_more, "this node has got new keys"};
  if (run.orders().is_held()) return {Permit::hold, "the run is held"};
  if (executor_.is_refused() && is_late(run, task, step)) {
    return {Permit::too_late, late_text(run, task)};
  }
  return {Permit::go, {}};
}

/// The higher priority first; of two alike the one whose task this robot began longest ago, so that no run starves the
/// younger ones; then the older.
std::vector<const Run*> RobotSchedule::by_turn() const {
  std::vector<const Run*> out(runs_.runs().begin(), runs_.runs().end());
  constexpr MonotonicTime kNever{std::numeric_limits<std::int64_t>::min()};
  const auto turn = [&](const Run* run) {
    return std::pair(kMaxPriority - run->definition().start().priority, run->work().served().value_or(kNever));
  };
  std::ranges::stable_sort(out, {}, turn);
  return out;
}

void RobotSchedule::start_next(Step step) {
  executor_.want_adapter(false);
  resume_attempt();
  if (executor_.attempt() || lost_.open()) return;
  const bool is_blocked = !executor_.obstacle({}).empty();
  for (const Run* run : by_turn()) {
    const bool may_start = run->may_start(step.steady) && !run->open_tasks().startable().empty();
    if (may_start && start_of(*runs_.find(run->id()), is_blocked, step)) return;
  }
}

/// Without its journal this node does not know what it has done: the run's judge has the results. It is asked for all
/// of this node's tasks at once.
bool RobotSchedule::is_surely_new(Run& run, TaskIndex task, UtcTime now) const {
  if (!lost_.may_have_held(run.definition().start().created, now) || run.epochs().judges_here()) return true;
  AwaitedRecords& awaited = run.work().awaited();
  const std::string& judge = run.definition().rule().judge();
  if (awaited.has_answered(judge, task)) return true;
  for (const TaskIndex own : run.epochs().own_tasks()) {
    if (run.facts().current(own) == nullptr && !awaited.has_answered(judge, own))
      awaited.need_result(own, judge, judge);
  }
  return false;
}

bool RobotSchedule::start_of(Run& run, bool is_blocked, Step step) {
  for (const TaskIndex task : run.open_tasks().startable()) {
    if (run.work().timers().waits(task)) continue;
    if (!is_surely_new(run, task, step.now.utc)) continue;
    if (!is_blocked && executor_.obstacle(run.tasks()[task].skill).empty()) {
      start(run, task, step);
      return true;
    }
    executor_.want_adapter(true);
  }
  return false;
}

void RobotSchedule::start(Run& run, TaskIndex task, Step step) {
  if (const auto data = data_for(run, task); !data) {
    return run.work().withheld().fail(task, data.error().text());  // at the step's end
  }
  JournalStart fact;
  fact.key = {run.id(), run.tasks()[task].id, 1, run.facts().next_attempt(task)};
  fact.epoch = run.epochs().current();
  fact.instance = executor_.adapter()->instance;
  fact.time = step.now.utc.ns;
  step.out.record(fact);
  if (auto applied = run.apply(fact); !applied) {
    return step.out.log(LogLevel::error, "not_started", applied.error().text());
  }
  run.work().note_served(step.now.mono);
  executor_.begin(attempt_for(runs_, run, fact), step.now, step.out);
  notify_progress(run, fact.key, TaskState::initializing, {}, step);
}

void RobotSchedule::notify_wait(Step step) {
  const std::string wait = executor_.take_wait(step.now);
  if (wait.empty()) return;
  const AttemptKey& key = executor_.attempt()->execute.key;
  const Run* run = runs_.find(key.run);
  if (run == nullptr) return;
  const std::string text = "task '" + key.task + "' on '" + run->epochs().self() + "': " + wait;
  notify_progress(*run, key, TaskState::initializing, cut_utf8(text, kMaxWait), step);
}

}  // namespace trb::scheduler
