#include "services/scheduler/core/run/results.hpp"

#include <algorithm>
#include <set>
#include <tuple>

namespace trb::scheduler {
namespace {

/// Smaller is kept rather.
int weight(TaskOutcome outcome) {
  if (outcome == TaskOutcome::finished) return 0;
  return outcome == TaskOutcome::skipped ? 1 : 2;
}

auto preference(const HeldResult& held) {
  const TaskResult& is = held.result;
  return std::tuple(is.key.iteration, is.key.attempt, weight(is.outcome), ~is.epoch,
                    std::string_view(held.record.payload.bytes));
}

bool before(const HeldResult& a, const HeldResult& b) {
  return preference(a) < preference(b);
}

}  // namespace

bool is_final(TaskOutcome outcome) {
  return outcome == TaskOutcome::finished || outcome == TaskOutcome::skipped;
}

bool ResultSet::grows_by(TaskIndex task, const HeldResult& result) const {
  const auto found = by_task_.find(task);
  if (found == by_task_.end()) return true;
  const auto& list = found->second;
  const auto place = std::lower_bound(list.begin(), list.end(), result, before);
  if (place != list.end() && preference(*place) == preference(result)) return false;
  const auto same = [&](const HeldResult& held) { return held.result.key == result.result.key; };
  const auto preferred = std::count_if(list.begin(), place, same);
  return preferred < static_cast<std::ptrdiff_t>(kMaxPerAttempt);
}

bool ResultSet::add(TaskIndex task, HeldResult result) {
  if (!grows_by(task, result)) return false;
  auto& list = by_task_[task];
  const auto place = std::lower_bound(list.begin(), list.end(), result, before);
  const auto same = [key = result.result.key](const HeldResult& held) { return held.result.key == key; };
  const std::size_t size = result.record.payload.bytes.size() + sizeof(HeldResult);
  bytes_[result.result.robot] += size;
  all_bytes_ += size;
  list.insert(place, std::move(result));
  if (static_cast<std::size_t>(std::count_if(list.begin(), list.end(), same)) > kMaxPerAttempt)
    list.erase(std::prev(std::find_if(list.rbegin(), list.rend(), same).base()));
  return true;
}

std::size_t ResultSet::bytes_of(const std::string& robot) const {
  const auto found = bytes_.find(robot);
  return found == bytes_.end() ? 0 : found->second;
}

void ResultSet::join(const ResultSet& other) {
  for (const auto& [task, list] : other.by_task_) {
    for (const HeldResult& held : list) add(task, held);
  }
}

const HeldResult* ResultSet::of(TaskIndex task) const {
  const auto found = by_task_.find(task);
  if (found == by_task_.end()) return nullptr;
  const auto& list = found->second;
  for (const TaskOutcome outcome : {TaskOutcome::finished, TaskOutcome::skipped}) {
    const auto first =
        std::find_if(list.begin(), list.end(), [&](const HeldResult& held) { return held.result.outcome == outcome; });
    if (first != list.end()) return &*first;
  }
  const auto age = [](const HeldResult& held) {
    return std::tuple(held.result.key.iteration, held.result.epoch, held.result.key.attempt);
  };
  return &*std::max_element(list.begin(), list.end(),
                            [&](const HeldResult& a, const HeldResult& b) { return age(a) < age(b); });
}

std::vector<const HeldResult*> ResultSet::proof_of(TaskIndex task, const std::string& robot) const {
  const HeldResult* counts = of(task);
  if (counts == nullptr) return {};
  const HeldResult* other = nullptr;
  for (const HeldResult& held : by_task_.at(task)) {
    if (&held == counts || held.result.outcome != TaskOutcome::finished) continue;
    if (other == nullptr || (held.result.robot == robot && other->result.robot != robot)) other = &held;
  }
  if (other == nullptr) return {counts};
  return {counts, other};
}

bool ResultSet::has_final(TaskIndex task) const {
  const HeldResult* held = of(task);
  return held != nullptr && is_final(held->result.outcome);
}

bool ResultSet::is_skipped(TaskIndex task) const {
  const HeldResult* held = of(task);
  return held != nullptr && held->result.outcome == TaskOutcome::skipped;
}

bool ResultSet::holds(TaskIndex task, const AttemptKey& key, const std::string& robot) const {
  const auto found = by_task_.find(task);
  if (found == by_task_.end()) return false;
  return std::any_of(found->second.begin(), found->second.end(),
                     [&](const HeldResult& held) { return held.result.key == key && held.result.robot == robot; });
}

std::uint32_t ResultSet::last_attempt(TaskIndex task, const std::string& robot, std::uint32_t epoch) const {
  std::uint32_t out = 0;
  const auto found = by_task_.find(task);
  if (found == by_task_.end()) return out;
  for (const HeldResult& held : found->second) {
    const TaskResult& is = held.result;
    if (is.robot == robot && is.epoch >= epoch) out = std::max(out, is.key.attempt);
  }
  return out;
}

std::vector<std::string> ResultSet::failed_by(TaskIndex task) const {
  std::set<std::string> out;
  const auto found = by_task_.find(task);
  if (found == by_task_.end()) return {};
  for (const HeldResult& held : found->second) {
    const TaskOutcome how = held.result.outcome;
    const bool failed = how == TaskOutcome::failed || how == TaskOutcome::retriable || how == TaskOutcome::interrupted;
    if (failed) out.insert(held.result.robot);
  }
  return {out.begin(), out.end()};
}

bool ResultSet::finished_twice(TaskIndex task) const {
  const auto found = by_task_.find(task);
  if (found == by_task_.end()) return false;
  const auto finished = [](const HeldResult& held) { return held.result.outcome == TaskOutcome::finished; };
  const auto& list = found->second;  // by iteration
  const auto first = std::find_if(list.begin(), list.end(), finished);
  if (first == list.end()) return false;
  for (auto at = std::next(first), before = first; at != list.end(); ++at) {
    if (!finished(*at)) continue;
    if (at->result.key.iteration == before->result.key.iteration) return true;
    before = at;
  }
  return false;
}

std::vector<bool> ResultSet::final_tasks(std::size_t tasks) const {
  std::vector<bool> out(tasks, false);
  for (const auto& [task, list] : by_task_) out[task] = has_final(task);
  return out;
}

std::vector<TaskIndex> ResultSet::tasks() const {
  std::vector<TaskIndex> out;
  for (const auto& [task, list] : by_task_) out.push_back(task);
  return out;
}

bool ResultSet::operator==(const ResultSet& other) const {
  const auto same = [](const HeldResult& a, const HeldResult& b) { return preference(a) == preference(b); };
  return std::equal(by_task_.begin(), by_task_.end(), other.by_task_.begin(), other.by_task_.end(),
                    [&](const auto& a, const auto& b) {
                      return a.first == b.first &&
                             std::equal(a.second.begin(), a.second.end(), b.second.begin(), b.second.end(), same);
                    });
}

}  // namespace trb::scheduler
