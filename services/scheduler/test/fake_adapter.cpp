#include "services/scheduler/test/fake_adapter.hpp"

#include <algorithm>
#include <utility>

namespace trb::scheduler::test {
namespace {

constexpr Duration kResend = std::chrono::seconds(1);

}  // namespace

void FakeAdapter::hear(const Inbound& message, MonotonicTime now) {
  if (const auto* is = get_if<Execute>(&message.body)) execute(*is, message, now);
  if (const auto* is = get_if<ExecutionQuery>(&message.body)) query(message, is->key);
  if (holds_alternative<AdapterStateRequest>(message.body)) {
    ++asked_state;
    tell_state(message.id);
  }
  if (const auto* is = get_if<OutcomeJournaled>(&message.body)) {
    if (const auto kept = outcomes_.find(is->key); kept != outcomes_.end()) kept->second.journaled = true;
  }
  if (const auto* is = get_if<CancelExecution>(&message.body)) {
    if (!is->begun.empty()) halted.push_back(is->begun);
    cancel(message, is->key, now);
  }
  if (const auto* is = get_if<TakeOutOfUse>(&message.body)) {
    out_of_use.push_back(is->what);
    if (message.wants_answer()) said_.push_back({message.id, Ack{"out_of_use", ""}});
    tell_state();
  }
}

void FakeAdapter::cancel(const Inbound& message, const AttemptKey& key, MonotonicTime now) {
  if (running_ && running_->key == key) {
    end(TaskOutcome::failed, "cancelled", now);
  } else if (!outcomes_.contains(key)) {
    keep({key, instance, TaskOutcome::failed, "cancelled before it began", "", 0}, now);
  }
  if (message.wants_answer()) answer_known(message, key);
}

void FakeAdapter::execute(const Execute& execute, const Inbound& message, MonotonicTime now) {
  if (execute.instance != instance) return refuse(message, Errc::stale_instance);
  ++commanded[{instance, execute.key}];
  if (answer_known(message, execute.key)) return;
  if (const auto why = refusal(execute)) return refuse(message, *why);
  ++begun[{instance, execute.key}];
  given[execute.key] = execute.data;
  running_ = Running{execute.key, now + skill_time, execute};
  said_.push_back({message.id, ExecutionState{execute.key, instance, "running"}});
  tell_state();
}

std::optional<Errc> FakeAdapter::refusal(const Execute& execute) const {
  if (fenced_) return Errc::fenced;
  if (!control_.empty()) return Errc::control_held;
  if (is_out_of_use(execute.skill)) return Errc::out_of_use;
  if (running_) return Errc::busy;
  if (!online_) return Errc::robot_offline;
  return std::nullopt;
}

bool FakeAdapter::answer_known(const Inbound& message, const AttemptKey& key) {
  const auto kept = outcomes_.find(key);
  if (running_ && running_->key == key) {
    said_.push_back({message.id, ExecutionState{key, instance, "running"}});
  } else if (kept != outcomes_.end()) {
    said_.push_back({message.id, kept->second.outcome});
  } else {
    return false;
  }
  return true;
}

bool FakeAdapter::is_out_of_use(const std::string& skill) const {
  const auto use = std::ranges::find(skills, skill, &SkillUse::name);
  return std::ranges::any_of(out_of_use, [&](const OutOfUse& one) {
    return one.capability.empty() || (use != skills.end() && use->capability == one.capability);
  });
}

void FakeAdapter::query(const Inbound& message, const AttemptKey& key) {
  if (!answer_known(message, key)) said_.push_back({message.id, ExecutionState{key, instance, "unknown"}});
}

void FakeAdapter::keep(const Outcome& outcome, MonotonicTime now) {
  outcomes_[outcome.key] = {outcome, false};
  said_.push_back({0, outcome});
  if (!resend_) resend_ = now + kResend;
}

void FakeAdapter::end(TaskOutcome outcome, const std::string& reason, MonotonicTime now, const std::string& result) {
  const Outcome told{running_->key, instance, outcome, reason, result, to_seconds(skill_time)};
  running_.reset();
  keep(told, now);
  if (tells_free) tell_state();
}

void FakeAdapter::end_by_itself(MonotonicTime now) {
  const char* const stuck = "the gripper is stuck";
  if (world) {
    const auto [how, result] = world(running_->execute);
    return end(how, how == TaskOutcome::finished ? "" : stuck, now, result);
  }
  const auto own = endings.find(running_->key.task);
  const TaskOutcome how = own == endings.end() ? ending : own->second;
  end(how, how == TaskOutcome::finished ? "" : stuck, now);
}

void FakeAdapter::tick(MonotonicTime now) {
  if (std::exchange(changed_, false)) {
    const bool breaks_off = running_ && (!online_ || fenced_);
    breaks_off ? end(TaskOutcome::interrupted, "stopped, or not reached any more", now, "") : tell_state();
  }
  if (running_ && running_->until <= now) end_by_itself(now);
  if (!resend_ || *resend_ > now) return;
  resend_.reset();
  for (const auto& [key, kept] : outcomes_) {
    if (kept.journaled) continue;
    said_.push_back({0, kept.outcome});
    resend_ = now + kResend;
  }
}

std::optional<MonotonicTime> FakeAdapter::next() const {
  if (changed_ || !said_.empty()) return MonotonicTime{0};
  return earlier(running_ ? std::optional(running_->until) : std::nullopt, resend_);
}

std::vector<FakeAdapter::Said> FakeAdapter::take() {
  std::vector<Said> out;
  out.swap(said_);
  return out;
}

std::vector<AttemptKey> FakeAdapter::restart() {
  std::vector<AttemptKey> out;
  if (running_) out.push_back(running_->key);
  for (const auto& [key, kept] : outcomes_) {
    if (!kept.journaled) out.push_back(key);
  }
  ++instance;
  running_.reset();
  outcomes_.clear();
  tell_state();
  return out;
}

void FakeAdapter::set(bool online, bool is_fenced) {
  online_ = online;
  fenced_ = is_fenced;
  changed_ = true;
}

void FakeAdapter::take_into_use(const TakeIntoUse& word) {
  std::erase_if(out_of_use, [&](const OutOfUse& one) {
    return one.retired == word.retired && (word.capability.empty() || one.capability == word.capability);
  });
  tell_state();
}

void FakeAdapter::forget(const std::string& run) {
  std::erase_if(given, [&](const auto& one) { return one.first.run == run; });
  std::erase_if(outcomes_, [&](const auto& one) { return one.first.run == run; });
  for (auto* counts : {&begun, &commanded}) {
    std::erase_if(*counts, [&](const auto& one) { return one.first.second.run == run; });
  }
}

void FakeAdapter::set_out_of_use(std::vector<OutOfUse> what) {
  out_of_use = std::move(what);
  tell_state();
}

void FakeAdapter::set_control(const std::string& holder) {
  control_ = holder;
  tell_state();
}

void FakeAdapter::tell_state(std::uint64_t reply_to) {
  said_.push_back({reply_to, AdapterState{instance, online_ ? "ONLINE" : "CONNECTION_BROKEN", fenced_,
                                          running_.has_value(), control_, out_of_use, skills}});
}

void FakeAdapter::refuse(const Inbound& message, Errc code) {
  said_.push_back({message.id, Nack{std::string(errc_name(code)), "execute", message.target, "not now", ""}});
}

}  // namespace trb::scheduler::test
