#include "services/scheduler/core/run/task_timers.hpp"

#include <algorithm>
#include <utility>

namespace trb::scheduler {
namespace {

void keep(TaskTimers::Times& times, std::vector<TaskIndex> tasks, MonotonicTime at) {
  std::ranges::sort(tasks);
  std::erase_if(times, [&](const auto& one) { return !std::ranges::binary_search(tasks, one.first); });
  for (const TaskIndex task : tasks) times.try_emplace(task, at);
}

}  // namespace

void TaskTimers::drop_past_retries(MonotonicTime now) {
  // What waited for that is due from now on.
  if (std::erase_if(retry_at_, [&](const auto& one) { return one.second <= now; }) != 0) version_.reset();
}

bool TaskTimers::take_version(std::uint64_t version) {
  return std::exchange(version_, version) != version;
}

void TaskTimers::set_due(std::vector<TaskIndex> tasks, MonotonicTime now) {
  keep(due_since_, std::move(tasks), now);
}

void TaskTimers::set_unbound(std::vector<TaskIndex> tasks, MonotonicTime now) {
  keep(unbound_since_, std::move(tasks), now);
}

bool TaskTimers::is_late(TaskIndex task, double within_s, MonotonicTime now) const {
  if (within_s <= 0) return false;
  const auto due = due_since_.find(task);
  return due != due_since_.end() && due->second + seconds(within_s) <= now;
}

void TaskTimers::set_passes(std::vector<TaskIndex> tasks, MonotonicTime at) {
  keep(pass_at_, std::move(tasks), at);
}

std::vector<TaskIndex> TaskTimers::take_due_passes(MonotonicTime now, MonotonicTime again) {
  std::vector<TaskIndex> out;
  for (auto& [task, at] : pass_at_) {
    if (at > now) continue;
    at = again;
    out.push_back(task);
  }
  return out;
}

std::optional<MonotonicTime> TaskTimers::next() const {
  std::optional<MonotonicTime> out;
  for (const Times* times : {&retry_at_, &pass_at_}) {
    for (const auto& [task, at] : *times) out = earlier(out, at);
  }
  return out;
}

}  // namespace trb::scheduler
