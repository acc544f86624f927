#include "services/scheduler/core/run/deliveries.hpp"

#include <algorithm>

namespace trb::scheduler {
namespace {

/// Tasks of one baton: the choices on so many, their tasks and what was read, take 300 kB, beside 512 kB of results.
constexpr std::size_t kMostPassed = 64;

/// Puts a task into the group of its robot; groups stay in the order of their first task.
void group(std::vector<std::pair<std::string, std::vector<TaskIndex>>>& groups, const std::string& robot,
           TaskIndex task) {
  for (auto& [to, tasks] : groups) {
    if (to == robot && tasks.size() < kMostPassed) {
      tasks.push_back(task);
      return;
    }
  }
  groups.push_back({robot, {task}});
}

}  // namespace

void Deliveries::owe_first_batons() {
  std::vector<TaskIndex> first;
  for (std::size_t i = 0; i < definition_.tasks().size(); ++i) {
    if (definition_.tasks()[i].after.empty()) first.push_back(static_cast<TaskIndex>(i));
  }
  owe_batons(first);
  for (const std::string& cloud : members_.clouds_without(epochs_.self())) {
    pending_.owe(DeliveryKind::baton, cloud, {});
  }
}

void Deliveries::owe_result(TaskIndex task) {
  std::vector<std::string> to = members_.clouds_without(epochs_.self());
  const std::string& submitter = definition_.start().submitter;
  if (to.empty() && submitter != epochs_.self()) to.push_back(submitter);
  for (const std::string& node : to) pending_.owe(DeliveryKind::results, node, {task});
}

void Deliveries::owe_late_result(TaskIndex task) {
  const std::string& now = epochs_.robot_of(task);
  const bool late = facts_.results().has_final(task) && facts_.results().of(task)->result.robot != now;
  if (late && epochs_.decides_here() && now != epochs_.self()) pending_.owe(DeliveryKind::results, now, {task});
}

const std::string& Deliveries::next_actor(TaskIndex task) const {
  const bool to_choose =
      definition_.is_conditional(task) && !epochs_.chooses_here(task) && facts_.choice_on(task) == nullptr;
  return to_choose ? epochs_.chooser_of(task) : epochs_.robot_of(task);
}

void Deliveries::owe_batons(const std::vector<TaskIndex>& tasks) {
  std::vector<std::pair<std::string, std::vector<TaskIndex>>> groups;
  for (const TaskIndex task : tasks) {
    if (next_actor(task) != epochs_.self()) group(groups, next_actor(task), task);
  }
  for (const auto& [to, next] : groups) pending_.owe(DeliveryKind::baton, to, next);
}

/// A successor is passed on once, when the last of its predecessors that are this node's is final: so an
/// acknowledgement, which names tasks only, can never be taken for that of another baton. One whose condition is
/// evaluated here is passed with the choice, or, if none will be made because all before it is SKIPPED, when that is
/// so.
bool Deliveries::is_ready_after(TaskIndex next, TaskIndex task) const {
  if (epochs_.chooses_here(next)) return facts_.all_before_skipped(next) && facts_.choice_on(next) == nullptr;
  return (epochs_.is_own(task) && facts_.own_before_final(next)) || (decider_gives(next) && !has_passed(next));
}

void Deliveries::owe_batons_after(TaskIndex task) {
  std::vector<TaskIndex> passed;
  for (const TaskIndex next : definition_.successors(task)) {
    if (is_ready_after(next, task)) passed.push_back(next);
  }
  owe_batons(passed);
}

void Deliveries::owe_to_members(DeliveryKind kind) {
  for (const std::string& member : members_.ids()) {
    if (member != epochs_.self()) pending_.owe(kind, member, {});
  }
}

/// Which batons this node owes by the facts that it holds.
bool Deliveries::gives(TaskIndex task) const {
  const auto& after = definition_.tasks()[task].after;
  if (after.empty()) return submitted_here_ || (epochs_.decides_here() && epochs_.is_ruled(task));
  if (epochs_.chooses_here(task)) return facts_.choice_on(task) != nullptr || facts_.all_before_skipped(task);
  const bool own = std::ranges::any_of(after, [&](TaskIndex before) { return epochs_.is_own(before); });
  return (own && facts_.own_before_final(task)) || decider_gives(task);
}

/// The decider passes on what its decision has given to another robot, and what a robot has finished that was replaced
/// since (that one is no actor any more) or that a person has said stands: it may never pass it on.
bool Deliveries::decider_gives(TaskIndex task) const {
  if (!epochs_.decides_here() || !facts_.all_before_final(task)) return false;
  return epochs_.is_ruled(task) || std::ranges::any_of(definition_.tasks()[task].after, [&](TaskIndex before) {
           const std::string& by = facts_.results().of(before)->result.robot;
           return by != epochs_.robot_of(before) || epochs_.is_vouched_still(by);
         });
}

void Deliveries::note_passed(const std::vector<TaskIndex>& tasks, const std::string& to, std::uint32_t epoch) {
  for (const TaskIndex task : tasks) passed_[{task, to}] = epoch;
}

void Deliveries::note_reads_short(const std::string& node, bool reads) {
  if (!reads) {
    short_readers_.erase(node);
  } else if (members_.contains(node)) {
    short_readers_.insert(node);
  }
}

bool Deliveries::has_passed(TaskIndex task) const {
  const auto passed = passed_.find({task, next_actor(task)});
  return passed != passed_.end() && passed->second >= epochs_.since(task);
}

std::vector<TaskIndex> Deliveries::unpassed() const {
  std::vector<TaskIndex> out;
  if (!epochs_.decides_here()) return out;
  for (std::size_t i = 0; i < definition_.tasks().size(); ++i) {
    const auto task = static_cast<TaskIndex>(i);
    const bool is_open = facts_.results().of(task) == nullptr && !definition_.tasks()[task].after.empty() &&
                         next_actor(task) != epochs_.self();
    if (is_open && !has_passed(task) && facts_.all_before_final(task)) out.push_back(task);
  }
  return out;
}

void Deliveries::owe_batons_anew() {
  pending_.drop_batons();
  std::vector<TaskIndex> open;
  for (std::size_t i = 0; i < definition_.tasks().size(); ++i) {
    const auto task = static_cast<TaskIndex>(i);
    if (!facts_.results().has_final(task) && !has_passed(task) && gives(task)) open.push_back(task);
  }
  owe_batons(open);
}

}  // namespace trb::scheduler
