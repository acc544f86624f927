#include "services/scheduler/core/run/facts.hpp"

#include <algorithm>
#include <limits>

#include "common/scenario/condition.hpp"

namespace trb::scheduler {

Facts::Facts(const RunDefinition& definition, const Epochs& epochs)
    : definition_(definition), epochs_(epochs), open_(definition.tasks().size()) {
  for (const Task& task : definition.tasks()) before_.push_back({task.after.size(), task.after.size()});
}

bool Facts::add(TaskIndex task, HeldResult held) {
  const bool was_final = results_.has_final(task);
  const bool took_along = takes_along(task);
  if (!results_.add(task, std::move(held))) return false;
  ++changes_;
  const std::size_t ended = !was_final && results_.has_final(task) ? 1 : 0;
  const bool takes = takes_along(task);
  open_ -= ended;
  if (ended == 0 && takes == took_along) return true;
  for (const TaskIndex next : definition_.successors(task)) {
    before_[next].open -= ended;
    // Who has done it after all pushes out that it was SKIPPED.
    before_[next].going = before_[next].going + (took_along ? 1 : 0) - (takes ? 1 : 0);
  }
  return true;
}

void Facts::add(TaskIndex task, const JournalStart& start) {
  starts_[task] = start;
  ++changes_;
}

std::vector<TaskIndex> Facts::add(const std::shared_ptr<const HeldChoice>& held) {
  std::vector<TaskIndex> out;
  for (const ChosenTask& chosen : held->choice.tasks) {
    const TaskIndex task = *definition_.index_of(chosen.task);
    if (choices_.emplace(task, held).second) out.push_back(task);
  }
  changes_ += out.size();
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
  const double first_s = definition_.tasks()[task].retry_after_s;
  const double longest_s = std::max(first_s, 60.0);  // nobody tries earlier than the scenario says
  double pause_s = first_s;
  for (std::uint32_t i = epochs_.first_attempt(task) + 1; i < next_attempt(task); ++i)
    pause_s = std::min(pause_s * 2, longest_s);
  return seconds(std::clamp(pause_s, 0.0, 3600.0));
}

std::optional<UtcTime> Facts::tried_again_at(TaskIndex task) const {
  const HeldResult* last = results_.of(task);
  if (last == nullptr || last->result.robot != epochs_.robot_of(task) || !tries_again(task, last->result))
    return std::nullopt;
  // Its robot says when it ended: any number.
  const Duration pause = retry_pause(task);
  constexpr std::int64_t kMost = std::numeric_limits<std::int64_t>::max();
  return UtcTime{std::clamp<std::int64_t>(last->result.ended, 0, kMost - pause.count())} + pause;
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

bool Facts::awaits_result(TaskIndex task, const AttemptKey& key) const {
  const auto start = starts_.find(task);
  return start != starts_.end() && start->second.key == key && !results_.holds(task, key, epochs_.self());
}

bool Facts::takes_along(TaskIndex task) const {
  return results_.is_skipped(task) && !results_.of(task)->result.goes_on;
}

bool Facts::all_before_skipped(TaskIndex task) const {
  return !definition_.tasks()[task].after.empty() && before_[task].going == 0;
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
  const std::pair now(changes_, epochs_.current());
  if (ending_of_ != now) {
    ending_ = find_ending_task();
    ending_of_ = now;
  }
  return ending_;
}

std::optional<TaskIndex> Facts::find_ending_task() const {
  for (const TaskIndex task : results_.tasks()) {
    const HeldResult* held = current(task);
    const bool says = held != nullptr && (held->result.robot == epochs_.self() || epochs_.judges_here());
    if (says && definition_.ends_run(task, held->result)) return task;
  }
  return std::nullopt;
}

}  // namespace trb::scheduler
