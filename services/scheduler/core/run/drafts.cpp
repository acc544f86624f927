#include "services/scheduler/core/run/drafts.hpp"

#include "common/scenario/condition.hpp"
#include "proto/body.hpp"
#include "proto/value.hpp"
#include "services/scheduler/core/after_failure.hpp"

namespace trb::scheduler {
namespace {

constexpr std::size_t kLongestReason = 1024;

TaskResult own_result(const Run& run, TaskIndex task, TaskOutcome outcome, UtcTime now) {
  TaskResult out;
  out.key = {run.id(), run.tasks()[task].id, 1, run.facts().next_attempt(task)};
  out.digest = run.definition().start().digest;
  out.epoch = run.epochs().current();
  out.robot = run.epochs().self();
  out.outcome = outcome;
  out.started = now.ns;
  out.ended = now.ns;
  return out;
}

std::string decider_text(const Decision& by) {
  return "by decision of " + (by.person.empty() ? "the policy" : "'" + by.person + "'") +
         (by.reason.empty() ? "" : ": " + by.reason);
}

}  // namespace

TaskResult skipped_result(const Run& run, TaskIndex task, UtcTime now) {
  TaskResult out = own_result(run, task, TaskOutcome::skipped, now);
  const HeldChoice* held = run.facts().choice_on(task);
  if (run.epochs().is_skipped(task)) {
    out.goes_on = run.tasks()[task].on_failure == OnFailure::continue_;
    out.reason = cut_utf8(decider_text(run.epochs().last_decision_on(task)), kLongestReason);
  } else if (run.facts().all_before_skipped(task) || held == nullptr) {
    out.reason = "every task before it was skipped";
  } else {
    const Choice& choice = held->choice;
    out.reason = cut_utf8(verdict_text(run.tasks()[task].when.front(), choice.node, choice.reading), kLongestReason);
    out.data = to_json(choice.reading);
  }
  return out;
}

TaskResult released_result(const Run& run, TaskIndex task, UtcTime now) {
  TaskResult out = own_result(run, task, TaskOutcome::released, now);
  out.reason = run.epochs().is_unbound(task) ? "its robot is to be chosen"
                                             : "given back to '" + run.definition().rule().decider() + "', never begun";
  return out;
}

TaskResult unbegun_result(const Run& run, TaskIndex task, const std::string& why, UtcTime now) {
  const AfterFailure after = after_failure(TaskOutcome::failed, {.on_failure = run.tasks()[task].on_failure});
  TaskResult out = own_result(run, task, after.outcome, now);
  out.goes_on = after.goes_on;
  out.reason = cut_utf8(why, kLongestReason);
  return out;
}

Choice choice_by(const Run& run, const std::vector<TaskIndex>& tasks, const std::string& node,
                 const SensorReading& reading, UtcTime now) {
  Choice choice;
  choice.run = run.id();
  choice.digest = run.definition().start().digest;
  choice.epoch = run.epochs().current();
  choice.by = run.epochs().self();
  for (const TaskIndex task : tasks) {
    const Task& is = run.tasks()[task];
    choice.tasks.push_back({is.id, 1, holds(is.when.front(), reading)});
  }
  choice.node = node;
  choice.reading = reading;
  choice.time = now.ns;
  return choice;
}

AbortOrder abort_order(const Run& run, TaskIndex failed, UtcTime now) {
  const TaskResult& result = run.facts().current(failed)->result;
  const std::string why = "task '" + run.tasks()[failed].id + "' " + std::string(name_of(result.outcome)) + " on '" +
                          result.robot + "': " + result.reason;
  return {run.id(), run.epochs().self(), cut_utf8(why, 255), now.ns};
}

AbortOrder abort_order(const Run& run, TaskIndex unbegun, const std::string& why, UtcTime now) {
  return {run.id(), run.epochs().self(), cut_utf8("task '" + run.tasks()[unbegun].id + "': " + why, 255), now.ns};
}

PauseOrder hold_order(const Run& run, UtcTime now) {
  const std::vector<std::string> doubles = run.orders().doubles();  // never none: only they make the judge hold it
  const std::string why = "task '" + doubles.front() + "' has two different results (double_execution)";
  return {run.id(), run.orders().next_hold(run.pause_number()), true, run.epochs().self(), cut_utf8(why, 255), now.ns,
          doubles};
}

}  // namespace trb::scheduler
