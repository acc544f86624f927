#include "services/scheduler/core/run/facts.hpp"

#include <algorithm>

#include "common/scenario/condition.hpp"

namespace trb::scheduler {

std::vector<TaskIndex> Facts::add(const std::shared_ptr<const HeldChoice>& held) {
  std::vector<TaskIndex> out;
  for (const ChosenTask& chosen : held->choice.tasks) {
    const TaskIndex task = *definition_.index_of(chosen.task);
    if (choices_.emplace(task, held).second) out.push_back(task);
  }
  return out;
}

const HeldChoice* Facts::choice_on(TaskIndex task) const {
  const auto found = choices_.find(task);
  return found == choices_.end() ? nullptr : found->second.get();
}

const HeldResult* Facts::current(TaskIndex task) const {
  const HeldResult* held = results_.of(task);
  if (held == nullptr || is_final(held->result.outcome)) return held;
  // Who was replaced and did not know may have tried on: that says nothing of the robot that has the task now.
  const bool is_old = held->result.robot != epochs_.robot_of(task) || epochs_.is_void(task, held->result.key.attempt);
  return is_old || tries_again(task, held->result) ? nullptr : held;
}

bool Facts::tries_again(TaskIndex task, const TaskResult& result) const {
  const std::uint32_t first = epochs_.first_attempt(task);
  return result.outcome == TaskOutcome::retriable && result.key.attempt >= first && result.key.attempt < kMaxAttempts &&
         result.key.attempt - first < definition_.tasks()[task].retries;
}

Duration Facts::retry_pause(TaskIndex task) const {
  constexpr double kLongest_s = 60;
  double pause_s = definition_.tasks()[task].retry_after_s;
  for (std::uint32_t i = epochs_.first_attempt(task) + 1; i < next_attempt(task); ++i)
    pause_s = std::min(pause_s * 2, kLongest_s);
  return seconds(std::clamp(pause_s, 0.0, 3600.0));
}

std::uint32_t Facts::next_attempt(TaskIndex task) const {
  // Only what its robot has tried since it has the task: one that was replaced may count on, as far as it likes.
  const std::uint32_t last = results_.last_attempt(task, epochs_.robot_of(task), epochs_.since(task));
  return std::max(epochs_.first_attempt(task), last + 1);
}

bool Facts::has_begun(TaskIndex task) const {
  const auto start = starts_.find(task);
  return start != starts_.end() && start->second.key.attempt >= next_attempt(task);
}

const JournalStart* Facts::open_start() const {
  for (const auto& [task, start] : starts_) {
    if (!results_.holds(task, start.key, epochs_.self())) return &start;
  }
  return nullptr;
}

bool Facts::all_final() const {
  for (std::size_t i = 0; i < definition_.tasks().size(); ++i) {
    if (!results_.has_final(static_cast<TaskIndex>(i))) return false;
  }
  return true;
}

bool Facts::all_before_final(TaskIndex task) const {
  return std::ranges::all_of(definition_.tasks()[task].after,
                             [&](TaskIndex before) { return results_.has_final(before); });
}

bool Facts::takes_along(TaskIndex task) const {
  return results_.is_skipped(task) && !results_.of(task)->result.goes_on;
}

bool Facts::all_before_skipped(TaskIndex task) const {
  const auto& after = definition_.tasks()[task].after;
  return !after.empty() && std::ranges::all_of(after, [&](TaskIndex before) { return takes_along(before); });
}

bool Facts::own_before_final(TaskIndex task) const {
  return std::ranges::all_of(definition_.tasks()[task].after,
                             [&](TaskIndex before) { return !epochs_.is_own(before) || results_.has_final(before); });
}

Fate Facts::fate_of(TaskIndex task) const {
  if (epochs_.is_skipped(task) || all_before_skipped(task)) return Fate::skipped;
  const Fate on = epochs_.is_unbound(task) ? Fate::binds : Fate::goes;
  if (!definition_.is_conditional(task)) return on;
  const HeldChoice* held = choice_on(task);
  if (held == nullptr) return Fate::undecided;
  return holds(definition_.tasks()[task].when.front(), held->choice.reading) ? on : Fate::skipped;
}

bool Facts::wants_robot(TaskIndex task) const {
  return epochs_.is_unbound(task) && results_.of(task) != nullptr && !results_.has_final(task);
}

std::vector<TaskIndex> Facts::problems() const {
  std::vector<TaskIndex> out;
  for (const TaskIndex task : results_.tasks()) {
    const HeldResult* held = current(task);
    const bool stands = held != nullptr && !is_final(held->result.outcome) && !epochs_.is_unbound(task);
    if (stands && !definition_.ends_run(task, held->result)) out.push_back(task);
  }
  return out;
}

std::optional<TaskIndex> Facts::ending_task() const {
  if (!definition_.aborts_on_failure()) return std::nullopt;
  for (const TaskIndex task : results_.tasks()) {
    const HeldResult* held = current(task);
    const bool says = held != nullptr && (held->result.robot == epochs_.self() || epochs_.judges_here());
    if (says && definition_.ends_run(task, held->result)) return task;
  }
  return std::nullopt;
}

}  // namespace trb::scheduler
