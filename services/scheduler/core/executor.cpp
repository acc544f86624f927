#include "services/scheduler/core/executor.hpp"

#include <algorithm>

#include "common/base/errc.hpp"
#include "proto/body.hpp"
#include "proto/value.hpp"
#include "services/scheduler/core/after_failure.hpp"
#include "services/scheduler/core/obstacle.hpp"
#include "services/scheduler/core/run/signature.hpp"

namespace trb::scheduler {
namespace {

constexpr Duration kQuestion = std::chrono::seconds(1);
constexpr Duration kNotifyAgain = std::chrono::seconds(10);
constexpr Duration kRunningQuestion = std::chrono::seconds(5);  // only finds a restart whose message was lost

/// Refusals that pass: the attempt was not begun, and may be commanded again later.
constexpr Errc kPassing[] = {
    Errc::busy,         Errc::fenced,         Errc::robot_offline,    Errc::timeout,
    Errc::expired,      Errc::queue_full,     Errc::no_service,       Errc::unknown_target,
    Errc::peer_expired, Errc::stale_instance, Errc::peer_unreachable, Errc::no_field_channel,
    Errc::control_held, Errc::out_of_use,
};

bool passes(const std::string& code) {
  return std::any_of(std::begin(kPassing), std::end(kPassing), [&](Errc one) { return errc_name(one) == code; });
}

}  // namespace

std::string Executor::obstacle(const std::string& skill) const {
  if (!adapter_) return "its mode-adapter has not reported yet";
  return obstacle_of(*adapter_, skill);
}

std::string Executor::obstacle() const {
  return attempt_ ? obstacle(attempt_->execute.skill) : std::string();
}

const SkillUse* Executor::find_skill(const std::string& skill) const {
  if (!adapter_) return nullptr;
  const auto at = std::find_if(adapter_->skills.begin(), adapter_->skills.end(),
                               [&](const SkillUse& one) { return one.name == skill; });
  return at == adapter_->skills.end() ? nullptr : &*at;
}

void Executor::welcome(Now now, Outbox& out) {
  adapter_.reset();
  next_state_request_ = now.mono + kQuestion;
  out.request(node_, AdapterStateRequest{});
  if (!attempt_) return;
  attempt_->next = now.mono;
  attempt_->next_cancel = now.mono;
}

void Executor::begin(Attempt attempt, Now now, Outbox& out) {
  attempt_ = std::move(attempt);
  attempt_->next_cancel = now.mono;
  command(now, out);
}

void Executor::resume(Attempt attempt) {
  attempt_ = std::move(attempt);
  attempt_->phase = Phase::commanded;  // ask first: only `unknown` permits another Execute
}

void Executor::command(Now now, Outbox& out) {
  attempt_->phase = Phase::commanded;
  attempt_->next = now.mono + kQuestion;
  out.command(node_, attempt_->execute, 0);
}

void Executor::command_if_possible(Now now, Outbox& out) {
  if (attempt_->permit == Permit::go && obstacle().empty()) {
    command(now, out);
  } else {
    attempt_->phase = Phase::refused;
  }
}

void Executor::allow(Permit permit, const std::string& why) {
  if (!attempt_) return;
  attempt_->permit = permit;
  attempt_->why = why;
  // What was refused will not be commanded again; its `unknown` will show whether it has begun all the same.
  const bool may_wait = permit == Permit::go || permit == Permit::hold;
  if (!may_wait && attempt_->phase == Phase::refused) attempt_->phase = Phase::commanded;
}

void Executor::query_state(Now now, Outbox& out) {
  attempt_->next = now.mono + (attempt_->phase == Phase::running ? kRunningQuestion : kQuestion);
  out.request(node_, ExecutionQuery{attempt_->execute.key});
}

void Executor::interrupt_if_other(std::uint64_t instance, Now now, Outbox& out) {
  if (!attempt_ || attempt_->phase == Phase::signing || instance == attempt_->execute.instance) return;
  // The robot may still carry out what the earlier process gave it: nothing else may begin before it is halted.
  if (attempt_->phase != Phase::refused) {
    const std::string why = "begun by an earlier process of the mode-adapter";
    out.command(node_, CancelExecution{attempt_->execute.key, why, attempt_->execute.skill});
  }
  end(TaskOutcome::interrupted, "the mode-adapter was started anew, nobody knows whether the task was done", now, out);
}

void Executor::on(const AdapterState& state, Now now, Outbox& out) {
  adapter_ = state;
  interrupt_if_other(state.instance, now, out);
  if (attempt_ && attempt_->phase == Phase::refused) command_if_possible(now, out);
}

void Executor::on(const ExecutionState& state, Now now, Outbox& out) {
  interrupt_if_other(state.instance, now, out);
  if (attempt_->phase == Phase::signing) return;
  if (state.state == "running") {
    attempt_->phase = Phase::running;
    attempt_->next = now.mono + kRunningQuestion;
  } else if (attempt_->phase != Phase::commanded) {
    return;  // what runs is not unknown to the same instance
  } else {
    end_unbegun(now, out);
  }
}

/// The mode-adapter does not know it: it was never begun.
void Executor::end_unbegun(Now now, Outbox& out) {
  switch (attempt_->permit) {
    case Permit::go:
    case Permit::hold:
      return command_if_possible(now, out);
    case Permit::give_back:
    case Permit::stop:
      return end(TaskOutcome::released, attempt_->why, now, out);
    case Permit::too_late:
      return end(TaskOutcome::failed, attempt_->why, now, out);
    case Permit::no_more:
    case Permit::cancel:
      return end(TaskOutcome::retriable, attempt_->why + " before it was begun", now, out);
  }
}

void Executor::on(const Outcome& outcome, Now now, Outbox& out) {
  // A later instance has an outcome only because it was ordered to cancel what it never knew.
  interrupt_if_other(outcome.instance, now, out);
  if (attempt_->phase == Phase::signing) return;
  if (adapter_ && adapter_->instance == outcome.instance) adapter_->busy = false;
  const bool fits = outcome.data.size() <= attempt_->most_data;
  attempt_->result.data = fits ? outcome.data : "";
  attempt_->result.duration_s = outcome.duration_s;
  const std::string left_out =
      "its data of " + std::to_string(outcome.data.size()) + " bytes is left out: this robot's results fill the run";
  end(outcome.outcome, fits ? outcome.reason : left_out + (outcome.reason.empty() ? "" : "; " + outcome.reason), now,
      out);
}

void Executor::on_refusal(const Nack& nack, Now now, Outbox& out) {
  if (!attempt_ || attempt_->phase != Phase::commanded) return;
  if (!passes(nack.code)) {
    end(TaskOutcome::failed, nack.code + ": " + nack.what, now, out);
    return;
  }
  // Which instance refused is asked: another than the start record's makes the attempt interrupted.
  if (attempt_->permit == Permit::go || attempt_->permit == Permit::hold) attempt_->phase = Phase::refused;
  adapter_.reset();
  next_state_request_ = std::max(next_state_request_, now.mono);
}

void Executor::end(TaskOutcome outcome, const std::string& reason, Now now, Outbox& out) {
  const SkillUse* use = find_skill(attempt_->execute.skill);
  const AfterFailure after = after_failure(outcome, {.permit = attempt_->permit,
                                                     .may_retry = attempt_->may_retry,
                                                     .repeatable = use != nullptr && use->repeatable,
                                                     .on_failure = attempt_->on_failure});
  TaskResult& result = attempt_->result;
  result.outcome = after.outcome;
  result.goes_on = after.goes_on;
  const bool skips = after.outcome == TaskOutcome::skipped;
  result.reason = cut_utf8(skips ? std::string(name_of(outcome)) + ", which skips it: " + reason : reason, 1024);
  result.ended = now.utc.ns;
  attempt_->phase = Phase::signing;
  attempt_->payload = encode(result);
  sign(now, out);
}

void Executor::sign(Now now, Outbox& out) {
  attempt_->next = now.mono + kSignAgain;
  out.request(node_, SignRequest{std::string(kSignedResult), {attempt_->payload}});
}

void Executor::done(Outbox& out) {
  out.information(node_, OutcomeJournaled{attempt_->execute.key});
  attempt_.reset();
}

/// It may still run, and is to stop.
bool Executor::is_to_stop() const {
  const bool stops = attempt_->permit == Permit::cancel || attempt_->permit == Permit::stop;
  return stops && attempt_->phase != Phase::signing;
}

void Executor::tick(Now now, Outbox& out) {
  const bool waits = wanted_ || (attempt_ && attempt_->phase == Phase::refused);
  if (waits && next_state_request_ <= now.mono) {
    next_state_request_ = now.mono + kQuestion;
    out.request(node_, AdapterStateRequest{});
  }
  if (!attempt_) return;
  if (is_to_stop() && attempt_->next_cancel <= now.mono) {
    attempt_->next_cancel = now.mono + kQuestion;
    out.command(node_, CancelExecution{attempt_->execute.key, attempt_->why});
  }
  if (attempt_->next > now.mono || attempt_->phase == Phase::refused) return;
  if (attempt_->phase == Phase::signing) {
    sign(now, out);
  } else {
    query_state(now, out);
  }
}

std::string Executor::take_wait(Now now) {
  // Right after a refusal the mode-adapter is asked why; it answers at once, or is not there.
  if (!is_refused() || (!adapter_ && attempt_->next > now.mono)) return {};
  std::string wait = obstacle();
  if (wait.empty() || (wait == attempt_->sent_wait && now.mono < attempt_->next_sent)) return {};
  attempt_->sent_wait = wait;
  attempt_->next_sent = now.mono + kNotifyAgain;
  return wait;
}

std::optional<MonotonicTime> Executor::next_deadline() const {
  std::optional<MonotonicTime> out;
  if (wanted_ || (attempt_ && attempt_->phase == Phase::refused)) out = next_state_request_;
  if (!attempt_) return out;
  if (attempt_->phase != Phase::refused) out = earlier(out, attempt_->next);
  if (is_to_stop()) out = earlier(out, attempt_->next_cancel);
  return out;
}

}  // namespace trb::scheduler
