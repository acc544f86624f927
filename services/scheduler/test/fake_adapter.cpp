#include "services/scheduler/test/fake_adapter.hpp"

#include <algorithm>

namespace trb::scheduler::test {

void FakeAdapter::hear(const Inbound& message, MonotonicTime now) {
  if (const auto* is = get_if<Execute>(&message.body)) execute(*is, message, now);
  if (const auto* is = get_if<ExecutionQuery>(&message.body)) query(is->key, message.id);
  if (holds_alternative<AdapterStateRequest>(message.body)) {
    ++asked_state;
    tell_state(message.id);
  }
  if (const auto* is = get_if<OutcomeJournaled>(&message.body)) outcomes_.erase(is->key);
  if (const auto* is = get_if<CancelExecution>(&message.body)) cancel(is->key, now);
  if (const auto* is = get_if<TakeOutOfUse>(&message.body)) {
    out_of_use.push_back(is->what);
    if (message.wants_answer()) said_.push_back({message.id, Ack{"out_of_use", ""}});
    tell_state();
  }
}

void FakeAdapter::cancel(const AttemptKey& key, MonotonicTime now) {
  if (running_ && running_->key == key) {
    end(TaskOutcome::failed, "cancelled");
  } else if (!outcomes_.contains(key)) {
    outcomes_[key] = {key, instance, TaskOutcome::failed, "cancelled before it began", "", 0};
    said_.push_back({0, outcomes_[key]});
  }
  resend_ = now + seconds(1);
}

void FakeAdapter::execute(const Execute& execute, const Inbound& message, MonotonicTime now) {
  if (execute.instance != instance) return refuse(message, Errc::stale_instance);
  ++commanded[{instance, execute.key}];
  if (begun.contains({instance, execute.key})) return query(execute.key, message.id);
  if (!online_) return refuse(message, Errc::robot_offline);
  if (fenced_) return refuse(message, Errc::fenced);
  if (!control_.empty()) return refuse(message, Errc::control_held);
  if (running_) return refuse(message, Errc::busy);
  if (is_out_of_use(execute.skill)) return refuse(message, Errc::out_of_use);
  ++begun[{instance, execute.key}];
  given[execute.key] = execute.data;
  running_ = Running{execute.key, now + skill_time, execute};
  said_.push_back({message.id, ExecutionState{execute.key, instance, "running"}});
  tell_state();
}

bool FakeAdapter::is_out_of_use(const std::string& skill) const {
  const auto use = std::ranges::find(skills, skill, &SkillUse::name);
  return std::ranges::any_of(out_of_use, [&](const OutOfUse& one) {
    return one.capability.empty() || (use != skills.end() && use->capability == one.capability);
  });
}

void FakeAdapter::query(const AttemptKey& key, std::uint64_t id) {
  if (const auto outcome = outcomes_.find(key); outcome != outcomes_.end()) {
    said_.push_back({id, outcome->second});
  } else {
    const bool runs = running_ && running_->key == key;
    said_.push_back({id, ExecutionState{key, instance, runs ? "running" : "unknown"}});
  }
}

void FakeAdapter::end(TaskOutcome outcome, const std::string& reason, const std::string& result) {
  Outcome told{running_->key, instance, outcome, reason, result, to_seconds(skill_time)};
  outcomes_[running_->key] = told;
  running_.reset();
  said_.push_back({0, told});
  if (tells_free) tell_state();
}

void FakeAdapter::end_by_itself() {
  const char* const stuck = "the gripper is stuck";
  if (world) {
    const auto [how, result] = world(running_->execute);
    return end(how, how == TaskOutcome::finished ? "" : stuck, result);
  }
  const auto own = endings.find(running_->key.task);
  const TaskOutcome how = own == endings.end() ? ending : own->second;
  end(how, how == TaskOutcome::finished ? "" : stuck);
}

void FakeAdapter::tick(MonotonicTime now) {
  if (running_ && running_->until <= now) {
    end_by_itself();
    resend_ = now + seconds(1);
  }
  if (!resend_ || *resend_ > now) return;
  for (const auto& [key, outcome] : outcomes_) said_.push_back({0, outcome});
  resend_ = outcomes_.empty() ? std::nullopt : std::optional(now + seconds(1));
}

std::optional<MonotonicTime> FakeAdapter::next() const {
  if (!said_.empty()) return MonotonicTime{0};
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
  for (const auto& [key, outcome] : outcomes_) out.push_back(key);
  ++instance;
  running_.reset();
  outcomes_.clear();
  tell_state();
  return out;
}

void FakeAdapter::set(bool online, bool is_fenced) {
  online_ = online;
  fenced_ = is_fenced;
  tell_state();
}

void FakeAdapter::take_into_use(const TakeIntoUse& word) {
  std::erase_if(out_of_use, [&](const OutOfUse& one) {
    return one.retired == word.retired && (word.capability.empty() || one.capability == word.capability);
  });
  tell_state();
}

void FakeAdapter::forget(const std::string& run) {
  std::erase_if(given, [&](const auto& one) { return one.first.run == run; });
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
  said_.push_back({reply_to, AdapterState{instance, online_ ? "ONLINE" : "OFFLINE", fenced_, running_.has_value(),
                                          control_, out_of_use, skills}});
}

void FakeAdapter::refuse(const Inbound& message, Errc code) {
  said_.push_back({message.id, Nack{std::string(errc_name(code)), "execute", message.target, "not now", ""}});
}

}  // namespace trb::scheduler::test
