#include "services/scheduler/core/handlers/robot_handler.hpp"

#include "services/scheduler/core/refusal.hpp"
#include "services/scheduler/core/robot_schedule.hpp"

namespace trb::scheduler {

void RobotHandler::handle(const AdapterState& body, const Inbound& from, Step step) {
  if (from.source != node_) return refuse(from, not_own(from), step);
  executor_.on(body, step.now, step.out);
}

void RobotHandler::handle(const ExecutionState& body, const Inbound& from, Step step) {
  if (from.source != node_) return refuse(from, not_own(from), step);
  const auto& attempt = executor_.attempt();
  if (!attempt || attempt->execute.key != body.key) return step.out.count("late.execution_state");
  const Phase before = attempt->phase;
  executor_.on(body, step.now, step.out);
  const Run* run = runs_.find(body.key.run);
  const bool began = before != Phase::running && executor_.attempt()->phase == Phase::running;
  if (began && run != nullptr) notify_progress(*run, body.key, TaskState::running, {}, step);
}

void RobotHandler::handle(const Outcome& body, const Inbound& from, Step step) {
  if (from.source != node_) return refuse(from, not_own(from), step);
  const bool ended = body.outcome != TaskOutcome::none && body.outcome != TaskOutcome::skipped;
  if (!ended) return refuse(from, fail(Errc::bad_value, "not the end of a task"), step);
  const auto& attempt = executor_.attempt();
  if (attempt && attempt->execute.key == body.key) return executor_.on(body, step.now, step.out);
  confirm_old(body, step);
}

/// Whether its result is held or no run needs it: the mode-adapter need not send it again.
void RobotHandler::confirm_old(const Outcome& body, Step step) {
  const Run* run = runs_.find(body.key.run);
  const auto task = run == nullptr ? std::nullopt : run->index_of(body.key.task);
  // Several start records are without a result where this node has got new keys: one after the other is taken up. Its
  // mode-adapter sends the outcome again until then; once it was told that it need not, it could forget it.
  const bool is_early = task && run->facts().awaits_result(*task, body.key) && !run->work().has_given_up_attempt();
  if (is_early) return step.out.count("early.outcome");
  const bool held = task && run->results().holds(*task, body.key, node_);
  if (!held)
    step.out.log(LogLevel::warning, "outcome_of_no_attempt", "task '" + body.key.task + "' of run " + body.key.run);
  step.out.count(held ? "late.outcome" : "refused.outcome.unknown_run");
  step.out.information(node_, OutcomeJournaled{body.key});
}

void RobotHandler::handle(const Ack& body, const Inbound& from, Step step) {
  if (from.source == node_ && body.state == "out_of_use") lost_.close(step.out);
}

bool RobotHandler::keep_signed(const SignedRecord& record, const Inbound& from, Step step) {
  const auto& attempt = executor_.attempt();
  const bool asked = attempt && attempt->phase == Phase::signing && record.kind == kSignedResult &&
                     record.payload.bytes == attempt->payload;
  if (!asked) return false;
  Run* run = runs_.find(attempt->execute.key.run);
  auto held = run == nullptr ? Result<HeldResult>(fail(Errc::unknown_run, "a signed result of no run"))
                             : run->checks().result(record);
  if (!held) {
    refuse(from, held.error(), step);
    if (run != nullptr) on_wrong_signature(*run, held.error(), step);
    return true;
  }
  journal_.keep_result(*run, std::move(*held), step);
  executor_.done(step.out);
  return true;
}

/// Another signature by the same key would not be believed either: the robot is free for other runs.
void RobotHandler::on_wrong_signature(Run& run, const Error& error, Step step) {
  if (error.code != Errc::bad_signature) return log_wrong_signature(error, step);
  withhold_unsigned(run, step);
  run.work().give_up_attempt();
  executor_.done(step.out);
}

}  // namespace trb::scheduler
