#include "services/scheduler/core/run/record_checks.hpp"

#include <set>

#include "common/scenario/condition.hpp"
#include "common/security/keys.hpp"
#include "proto/body.hpp"
#include "services/scheduler/core/run/orders.hpp"

namespace trb::scheduler {

Result<const Certificate*> RecordChecks::signer_of(const SignedRecord& record) const {
  const Certificate* signer = members_.find(record.signer);
  if (signer != nullptr) return signer;
  return fail(Errc::not_permitted, "run " + definition_.id() + ": '" + record.signer + "' is no member");
}

Result<HeldResult> RecordChecks::result(const SignedRecord& record) const {
  const auto signer = signer_of(record);
  if (!signer) return signer.error();
  auto result = open_record<TaskResult>(record, kSignedResult, **signer);
  if (!result) return result.error();
  const auto task = definition_.index_of(result->key.task);
  const std::string name = "run " + definition_.id() + ": result of task '" + result->key.task + "': ";
  if (result->key.run != definition_.id() || result->digest != definition_.start().digest) {
    return fail(Errc::conflict, name + "of another run");
  }
  if (result->epoch == 0 || result->epoch > epochs_.current()) return fail(Errc::conflict, name + "of another epoch");
  if (!task) return fail(Errc::bad_value, name + "no such task");
  if (auto checked = check_attempt(*task, *result); !checked) return checked.error();
  if (auto checked = check_author(*task, *result, **signer); !checked) return checked.error();
  return HeldResult{record, std::move(*result)};
}

Result<HeldResult> RecordChecks::received_result(const SignedRecord& record) const {
  auto held = result(record);
  if (!held) return held;
  const TaskResult& is = held->result;
  const TaskIndex task = *definition_.index_of(is.key.task);
  const std::uint32_t first = epochs_.first_attempt_in(task, is.epoch);
  const std::uint32_t unbegun = is.outcome == TaskOutcome::finished ? 0 : 1;
  if (is.key.attempt >= first && is.key.attempt - first <= definition_.tasks()[task].retries + unbegun) return held;
  return fail(Errc::bad_value, "run " + definition_.id() + ": result of task '" + is.key.task + "': attempt " +
                                   std::to_string(is.key.attempt) + " was not '" + is.robot + "''s in epoch " +
                                   std::to_string(is.epoch));
}

Status RecordChecks::check_attempt(TaskIndex task, const TaskResult& result) const {
  const std::string name = "run " + definition_.id() + ": result of task '" + result.key.task + "': ";
  const std::uint32_t attempt = result.key.attempt;
  const bool skipped = result.outcome == TaskOutcome::skipped;
  const std::uint32_t most = kMaxAttempts + (skipped ? 1 : 0);
  if (result.key.iteration != 1 || attempt == 0 || attempt > most || result.outcome == TaskOutcome::none) {
    return fail(Errc::bad_value, name + "no such attempt or outcome");
  }
  if (result.goes_on && !(skipped && definition_.tasks()[task].on_failure == OnFailure::continue_)) {
    return fail(Errc::bad_value, name + "nothing goes on behind it");
  }
  return Done{};
}

Status RecordChecks::check_author(TaskIndex task, const TaskResult& result, const Certificate& signer) const {
  const std::string name = "run " + definition_.id() + ": result of task '" + result.key.task + "': ";
  if (result.robot != signer.id || epochs_.robot_in(task, result.epoch) != signer.id) {
    return fail(Errc::not_permitted, name + "'" + signer.id + "' is not its robot");
  }
  // A cloud node does nothing: its task is one that a decision skips, or one that a decision has yet to give a robot.
  const bool gives_up = result.outcome == TaskOutcome::released && result.key.attempt == 1;
  if (signer.role == Role::cloud && result.outcome != TaskOutcome::skipped && !gives_up) {
    return fail(Errc::not_permitted, name + "'" + signer.id + "' can only skip it");
  }
  return Done{};
}

Result<HeldChoice> RecordChecks::choice(const SignedRecord& record) const {
  const auto signer = signer_of(record);
  if (!signer) return signer.error();
  auto choice = open_record<Choice>(record, kSignedChoice, **signer);
  if (!choice) return choice.error();
  const std::string name = "run " + definition_.id() + ": choice of '" + record.signer + "': ";
  if (choice->run != definition_.id() || choice->digest != definition_.start().digest) {
    return fail(Errc::conflict, name + "of another run");
  }
  if (choice->epoch == 0 || choice->epoch > epochs_.current()) return fail(Errc::conflict, name + "of another epoch");
  if (choice->by != record.signer) return fail(Errc::source_mismatch, name + "it names another node");
  if (choice->tasks.empty()) return fail(Errc::bad_value, name + "on no task");
  for (const ChosenTask& chosen : choice->tasks) {
    if (auto checked = check_verdict(*choice, chosen); !checked) return checked.error();
  }
  return HeldChoice{record, std::move(*choice)};
}

Status RecordChecks::check_verdict(const Choice& choice, const ChosenTask& chosen) const {
  const std::string name = "run " + definition_.id() + ": choice of '" + choice.by + "': ";
  const auto task = definition_.index_of(chosen.task);
  if (!task || !definition_.is_conditional(*task) || chosen.iteration != 1) {
    return fail(Errc::bad_value, name + "no condition on task '" + chosen.task + "'");
  }
  if (epochs_.robot_in(trb::chooser_of(definition_.start().scenario, *task), choice.epoch) != choice.by) {
    return fail(Errc::not_permitted, name + "on task '" + chosen.task + "' it is another's");
  }
  const Condition& condition = definition_.tasks()[*task].when.front();
  const bool bound = !condition.of.empty() && condition.identity.empty();
  const bool elsewhere = bound && choice.node != condition.of;
  const bool other = !condition.identity.empty() && choice.reading.identity != condition.identity;
  if (elsewhere || other) return fail(Errc::bad_value, name + "on task '" + chosen.task + "' by another sensor");
  if (!believe(condition, choice.reading) || holds(condition, choice.reading) != chosen.holds) {
    return fail(Errc::bad_value, name + "on task '" + chosen.task + "' its own reading says otherwise");
  }
  return Done{};
}

template <class Order>
Result<Order> RecordChecks::open_order(const SignedRecord& record, std::string_view purpose) const {
  const auto signer = signer_of(record);
  if (!signer) return signer.error();
  auto order = open_record<Order>(record, purpose, **signer);
  if (!order) return order;
  const std::string name = "run " + definition_.id() + ": ";
  if (order->run != definition_.id()) return fail(Errc::conflict, name + "the order is for another run");
  if (order->by != record.signer) return fail(Errc::source_mismatch, name + "the order names another node");
  return order;
}

Result<PauseOrder> RecordChecks::pause(const SignedRecord& record) const {
  auto order = open_order<PauseOrder>(record, kSignedRunPause);
  if (!order) return order;
  if (auto numbered = check_number(*order); !numbered) return numbered.error();
  return order;
}

Result<PauseOrder> RecordChecks::received_pause(const SignedRecord& record) const {
  auto order = pause(record);
  if (!order) return order;
  if (auto named = check_doubles(*order); !named) return named.error();
  return order;
}

Status RecordChecks::check_doubles(const PauseOrder& order) const {
  if (order.doubles.empty()) return Done{};
  const std::string& judge = definition_.rule().judge();
  const std::string name = "run " + definition_.id() + ": the order of '" + order.by + "' to " +
                           (order.paused ? "hold it" : "let it go on") + ": ";
  if (!(order.paused ? order.by == judge : outranks_robots(order.by))) {
    return fail(Errc::not_permitted, name + "which tasks were done twice is not said by '" + order.by + "'",
                "look at the robots, then say it on node '" + judge + "'");
  }
  std::set<std::string_view> tasks;
  for (const std::string& task : order.doubles) {
    if (definition_.index_of(task) && tasks.insert(task).second) continue;
    return fail(Errc::bad_value, name + "task '" + task + "', done twice, is no task or is named twice");
  }
  return Done{};
}

bool RecordChecks::outranks_robots(const std::string& node) const {
  const Certificate* member = members_.find(node);
  return node == definition_.rule().judge() || (member != nullptr && member->role == Role::cloud);
}

Status RecordChecks::check_number(const PauseOrder& order) const {
  const bool outranks = outranks_robots(order.by);
  const std::uint32_t most = outranks       ? kMaxPauses + (order.paused ? 0 : 1)
                             : order.paused ? kMaxRobotHold
                                            : kMaxRobotResume;
  if (order.number >= 1 && order.number <= most) return Done{};
  return fail(Errc::bad_value,
              "run " + definition_.id() + ": the order of '" + order.by + "' to " +
                  (order.paused ? "hold it" : "let it go on") + ": number " + std::to_string(order.number) +
                  " is not one of 1 to " + std::to_string(most),
              outranks ? "who was held so often is aborted and begun anew"
                       : "say it on node '" + definition_.rule().judge() + "', or abort the run");
}

Result<AbortOrder> RecordChecks::abort(const SignedRecord& record) const {
  return open_order<AbortOrder>(record, kSignedRunAbort);
}

Status RecordChecks::order(const SignedRecord& record) const {
  if (record.kind == kSignedRunAbort) {
    const auto checked = abort(record);
    return checked ? Status(Done{}) : checked.error();
  }
  const auto checked = received_pause(record);
  return checked ? Status(Done{}) : checked.error();
}

Result<RunEnd> RecordChecks::end(const SignedRecord& record) const {
  const std::string name = "run " + definition_.id() + ": its end: ";
  const std::string& judge = definition_.rule().judge();
  if (record.signer != judge) {
    return fail(Errc::not_permitted, name + "'" + record.signer + "' does not say it, '" + judge + "' does");
  }
  auto end = open_record<RunEnd>(record, kSignedRunEnd, *members_.find(judge));
  if (!end) return end;
  if (end->run != definition_.id() || end->digest != definition_.start().digest) {
    return fail(Errc::conflict, name + "of another run");
  }
  if (end->by != record.signer) return fail(Errc::source_mismatch, name + "it names another node");
  if (end->state != RunState::finished) return fail(Errc::bad_value, name + "only FINISHED is said so");
  return end;
}

}  // namespace trb::scheduler
