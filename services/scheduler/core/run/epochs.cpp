#include "services/scheduler/core/run/epochs.hpp"

#include <algorithm>

namespace trb::scheduler {
namespace {

const TaskRuling* find_ruling(const Decision& decision, const std::string& task) {
  const auto at = std::find_if(decision.tasks.begin(), decision.tasks.end(),
                               [&](const TaskRuling& ruling) { return ruling.task == task; });
  return at == decision.tasks.end() ? nullptr : &*at;
}

}  // namespace

Epochs::Epochs(const RunDefinition& definition, std::string self)
    : definition_(definition),
      self_(std::move(self)),
      robots_(definition.start().first.robots),
      since_(definition.tasks().size(), 1),
      first_attempt_(definition.tasks().size(), 1) {
  index_own_tasks();
}

void Epochs::index_own_tasks() {
  own_tasks_.clear();
  concerned_.clear();
  for (std::size_t i = 0; i < robots_.size(); ++i) {
    const auto task = static_cast<TaskIndex>(i);
    if (is_own(task)) own_tasks_.push_back(task);
    if (concerns(task)) concerned_.push_back(task);
  }
}

void Epochs::adopt(const SignedRecord& record, const Decision& decision) {
  records_.push_back(record);
  decisions_.push_back(decision);
  for (const TaskRuling& ruling : decision.tasks) {
    const TaskIndex task = *definition_.index_of(ruling.task);
    if (ruling.evidence == Evidence::word) vouched_still_.insert(robots_[task]);
    robots_[task] = ruling.robot;
    since_[task] = decision.epoch;
    first_attempt_[task] = ruling.attempt;
  }
  index_own_tasks();
}

const TaskRuling* Epochs::ruling_in(TaskIndex task, std::uint32_t epoch) const {
  for (std::size_t i = std::min<std::size_t>(decisions_.size(), epoch == 0 ? 0 : epoch - 1); i > 0; --i) {
    if (const TaskRuling* ruling = find_ruling(decisions_[i - 1], definition_.tasks()[task].id)) return ruling;
  }
  return nullptr;
}

const std::string& Epochs::robot_in(TaskIndex task, std::uint32_t epoch) const {
  const TaskRuling* ruling = ruling_in(task, epoch);
  return ruling == nullptr ? definition_.start().first.robots[task] : ruling->robot;
}

std::uint32_t Epochs::first_attempt_in(TaskIndex task, std::uint32_t epoch) const {
  const TaskRuling* ruling = ruling_in(task, epoch);
  return ruling == nullptr ? 1 : ruling->attempt;
}

bool Epochs::is_unbound(TaskIndex task) const {
  return !is_ruled(task) && definition_.rule().may_decide(robot_of(task));
}

bool Epochs::is_skipped(TaskIndex task) const {
  return is_ruled(task) && definition_.rule().may_decide(robot_of(task));
}

bool Epochs::is_of_epoch(const std::vector<TaskIndex>& tasks, std::uint32_t epoch) const {
  return std::all_of(tasks.begin(), tasks.end(),
                     [&](TaskIndex task) { return task < since_.size() && since_[task] <= epoch; });
}

const std::string& Epochs::chooser_of(TaskIndex task) const {
  return robot_of(trb::chooser_of(definition_.start().scenario, task));
}

bool Epochs::chooses_here(TaskIndex task) const {
  return definition_.is_conditional(task) && chooser_of(task) == self_;
}

}  // namespace trb::scheduler
