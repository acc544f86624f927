// Run: the journaled facts, and what this node comes to owe by them.
#include <algorithm>

#include "services/scheduler/core/run.hpp"

namespace trb::scheduler {
namespace {

Status not_of_this_run(const std::string& run, std::string_view what) {
  return fail(Errc::conflict, "run " + run + ": " + std::string(what) + " is not of this run");
}

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

Status Run::apply(const JournalRun& fact) {
  if (fact.start.payload != record_.payload) return not_of_this_run(id(), "a start");
  if (!fact.submitted_here || submitted_here_) return Done{};
  submitted_here_ = true;
  ++version_;
  if (!aborted()) owe_first_batons();
  return Done{};
}

Status Run::apply(const JournalStart& fact) {
  const auto task = index_of(fact.key.task);
  const bool ours = task && fact.epoch >= 1 && fact.epoch <= epoch() && robot_in(*task, fact.epoch) == self_;
  if (!ours) return not_of_this_run(id(), "a start record");
  starts_[*task] = fact;
  ++version_;
  return Done{};
}

Status Run::apply(const JournalResult& fact) {
  auto held = check_result(fact.result);
  if (!held) return held.error();
  add(std::move(*held));
  return Done{};
}

Status Run::apply(const JournalChoice& fact) {
  auto held = check_choice(fact.choice);
  if (!held) return held.error();
  add(std::move(*held));
  return Done{};
}

Status Run::apply(const JournalDelivered& fact) {
  for (const TaskIndex task : fact.tasks) {
    if (task >= tasks().size()) return not_of_this_run(id(), "a delivery");
  }
  for (const DeliveryKind kind :
       {DeliveryKind::baton, DeliveryKind::results, DeliveryKind::abort, DeliveryKind::decision, DeliveryKind::pause}) {
    if (fact.what == name_of(kind)) deliveries.settle(kind, fact.to, fact.tasks);
  }
  if (fact.what != name_of(DeliveryKind::baton)) return Done{};
  for (const TaskIndex task : fact.tasks) passed_[{task, fact.to}] = fact.epoch;
  return Done{};
}

bool Run::add(HeldResult held) {
  const TaskIndex task = *index_of(held.result.key.task);
  const bool was_final = results_.has_final(task);
  const bool own = held.result.robot == self_;
  const bool by_its_robot = held.result.robot == robot_of(task);
  const bool was_double = results_.finished_twice(task);
  if (!results_.add(task, std::move(held))) return false;
  const std::string& name = tasks()[task].id;
  if (!was_double && results_.finished_twice(task) && !seen_doubles_.contains(name)) doubles_.push_back(name);
  ++version_;
  if (results_.has_final(task)) needs.erase(task);
  if (by_its_robot || results_.has_final(task)) progress.erase(task);
  if (current(task) != nullptr) unbegun.erase(task);
  if (own) owe_results(task);
  owe_to_successor(task);
  if (!was_final && results_.has_final(task) && !aborted()) owe_batons_after(task);
  return true;
}

bool Run::add(HeldChoice held) {
  const auto shared = std::make_shared<const HeldChoice>(std::move(held));
  std::vector<TaskIndex> fresh;
  for (const ChosenTask& chosen : shared->choice.tasks) {
    const TaskIndex task = *index_of(chosen.task);
    if (!choices_.emplace(task, shared).second) continue;
    waits.erase(task);
    fresh.push_back(task);
    ++version_;
  }
  if (shared->choice.by == self_ && !aborted()) owe_batons(fresh);
  return !fresh.empty();
}

void Run::owe_results(TaskIndex task) {
  std::vector<std::string> to = clouds();
  if (to.empty() && start_.submitter != self_) to.push_back(start_.submitter);
  for (const std::string& node : to) deliveries.owe(DeliveryKind::results, node, {task});
}

/// A robot that was replaced had finished after all: whoever took its task over need not begin it.
void Run::owe_to_successor(TaskIndex task) {
  const std::string& now = robot_of(task);
  const bool late = results_.has_final(task) && results_.of(task)->result.robot != now;
  if (late && self_ == decider_ && now != self_) deliveries.owe(DeliveryKind::results, now, {task});
}

/// To the actors of the tasks that wait for nothing, and to the cloud, so that it knows the run.
void Run::owe_first_batons() {
  std::vector<TaskIndex> first;
  for (std::size_t i = 0; i < tasks().size(); ++i) {
    if (tasks()[i].after.empty()) first.push_back(static_cast<TaskIndex>(i));
  }
  owe_batons(first);
  for (const std::string& cloud : clouds()) deliveries.owe(DeliveryKind::baton, cloud, {});
}

const std::string& Run::next_hand(TaskIndex task) const {
  const bool to_choose = is_conditional(task) && !chooses_here(task) && choice_on(task) == nullptr;
  return to_choose ? chooser_of(task) : robot_of(task);
}

void Run::owe_batons(const std::vector<TaskIndex>& tasks) {
  std::vector<std::pair<std::string, std::vector<TaskIndex>>> groups;
  for (const TaskIndex task : tasks) {
    if (next_hand(task) != self_) group(groups, next_hand(task), task);
  }
  for (const auto& [to, next] : groups) deliveries.owe(DeliveryKind::baton, to, next);
}

/// A successor is passed on once, when the last of its predecessors that are this node's is final: so an
/// acknowledgement, which names tasks only, can never be taken for that of another baton. One whose condition is
/// evaluated here is passed with the choice, or, if none will be made because all before it is SKIPPED, when that is
/// so.
void Run::owe_batons_after(TaskIndex task) {
  std::vector<TaskIndex> passed;
  for (const TaskIndex next : successors_[task]) {
    const bool here = chooses_here(next);
    const bool ready =
        here ? all_before_skipped(next) && choice_on(next) == nullptr
             : (robot_of(task) == self_ && own_predecessors_final(next)) || (decider_gives(next) && !has_passed(next));
    if (ready) passed.push_back(next);
  }
  owe_batons(passed);
}

bool Run::own_predecessors_final(TaskIndex task) const {
  const auto& after = tasks()[task].after;
  return std::all_of(after.begin(), after.end(),
                     [&](TaskIndex before) { return robot_of(before) != self_ || results_.has_final(before); });
}

}  // namespace trb::scheduler
