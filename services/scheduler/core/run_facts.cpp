// Run: the journaled facts, and what this node comes to owe by them.
#include <algorithm>

#include "services/scheduler/core/run.hpp"

namespace trb::scheduler {
namespace {

Status not_of_this_run(const std::string& run, std::string_view what) {
  return fail(Errc::conflict, "run " + run + ": " + std::string(what) + " is not of this run");
}

/// Puts a task into the group of its robot; groups stay in the order of their first task.
void group(std::vector<std::pair<std::string, std::vector<TaskIndex>>>& groups, const std::string& robot,
           TaskIndex task) {
  for (auto& [to, tasks] : groups) {
    if (to == robot) {
      tasks.push_back(task);
      return;
    }
  }
  groups.push_back({robot, {task}});
}

}  // namespace

Status Run::apply(const JournalRun& fact) {
  if (fact.start.payload != record_.payload) return not_of_this_run(id(), "a start");
  if (!fact.submitted_here || submitted_here_) return Done{};
  submitted_here_ = true;
  if (!aborted()) owe_first_batons();
  return Done{};
}

Status Run::apply(const JournalStart& fact) {
  const auto task = index_of(fact.key.task);
  if (!task || robot_of(*task) != self_) return not_of_this_run(id(), "a start record");
  starts_[*task] = fact;
  return Done{};
}

Status Run::apply(const JournalResult& fact) {
  auto held = check_result(fact.result);
  if (!held) return held.error();
  add(std::move(*held));
  return Done{};
}

Status Run::apply(const JournalDelivered& fact) {
  for (const TaskIndex task : fact.tasks) {
    if (task >= tasks().size()) return not_of_this_run(id(), "a delivery");
  }
  for (const DutyKind kind : {DutyKind::baton, DutyKind::results, DutyKind::abort}) {
    if (fact.what == name_of(kind)) duties.settle(kind, fact.to, fact.tasks);
  }
  return Done{};
}

Status Run::apply(const JournalAbort& fact) {
  if (auto order = check_abort(fact.order); !order) return order.error();
  if (!abort_) abort_ = fact.order;
  duties.drop(DutyKind::baton);
  needs.clear();
  if (!fact.ordered_here || abort_ordered_here_) return Done{};
  abort_ordered_here_ = true;
  for (const Member& member : start_.members) {
    if (member.id != self_) duties.owe(DutyKind::abort, member.id, {});
  }
  return Done{};
}

bool Run::add(HeldResult held) {
  const TaskIndex task = *index_of(held.result.key.task);
  const bool was_final = results_.has_final(task);
  if (!results_.add(task, std::move(held))) return false;
  if (results_.has_final(task)) needs.erase(task);
  progress.erase(task);
  if (robot_of(task) != self_) return true;
  owe_results(task);
  if (!was_final && results_.has_final(task) && !aborted()) owe_batons_after(task);
  return true;
}

void Run::owe_results(TaskIndex task) {
  std::vector<std::string> to = clouds();
  if (to.empty() && start_.submitter != self_) to.push_back(start_.submitter);
  for (const std::string& node : to) duties.owe(DutyKind::results, node, {task});
}

/// To the actors of the tasks that wait for nothing, and to the cloud, so that it knows the run.
void Run::owe_first_batons() {
  std::vector<std::pair<std::string, std::vector<TaskIndex>>> groups;
  for (std::size_t i = 0; i < tasks().size(); ++i) {
    const auto task = static_cast<TaskIndex>(i);
    if (tasks()[i].after.empty() && robot_of(task) != self_) group(groups, robot_of(task), task);
  }
  for (const auto& [to, first] : groups) duties.owe(DutyKind::baton, to, first);
  for (const std::string& cloud : clouds()) duties.owe(DutyKind::baton, cloud, {});
}

/// A successor is passed on once, when the last of its predecessors that are this node's is final: so an
/// acknowledgement, which names tasks only, can never be taken for that of another baton.
void Run::owe_batons_after(TaskIndex task) {
  std::vector<std::pair<std::string, std::vector<TaskIndex>>> groups;
  for (const TaskIndex next : successors_[task]) {
    if (robot_of(next) != self_ && own_predecessors_final(next)) group(groups, robot_of(next), next);
  }
  for (const auto& [to, next] : groups) duties.owe(DutyKind::baton, to, next);
}

bool Run::own_predecessors_final(TaskIndex task) const {
  const auto& after = tasks()[task].after;
  return std::all_of(after.begin(), after.end(),
                     [&](TaskIndex before) { return robot_of(before) != self_ || results_.has_final(before); });
}

}  // namespace trb::scheduler
