#include "common/scenario/critical_path.hpp"

#include <algorithm>
#include <map>
#include <utility>

namespace trb {
namespace {

/// Times come as text with a few digits.
constexpr double kSame_s = 1e-3;

class Waits {
 public:
  explicit Waits(const std::vector<PlayedTask>& tasks) : tasks_(tasks), out_(tasks.size()) {
    for (std::size_t i = 0; i < tasks.size(); ++i) {
      by_id_[{tasks[i].run, tasks[i].id}].push_back(i);
      runs_ = std::max(runs_, tasks[i].run + 1);
      by_robot_[tasks[i].robot].push_back(i);
    }
  }

  std::vector<TaskWait> find() {
    for (std::size_t i = 0; i < tasks_.size(); ++i) {
      find_holder(i);
      const double since_s = out_[i].holder ? tasks_[*out_[i].holder].end_s : tasks_[i].since_s;
      out_[i].more_s = std::max(0.0, tasks_[i].begin_s - since_s);
    }
    for (std::size_t run = 0; run < runs_; ++run) mark_critical(run);
    return std::move(out_);
  }

 private:
  void consider(std::size_t task, std::size_t holder, bool is_robot_busy) {
    TaskWait& wait = out_[task];
    if (holder == task || tasks_[holder].end_s > tasks_[task].begin_s + kSame_s) return;
    if (wait.holder && tasks_[*wait.holder].end_s >= tasks_[holder].end_s) return;
    wait.holder = holder;
    wait.is_robot_busy = is_robot_busy;
  }

  /// Predecessors first: of two that end together, the one that the scenario names is the reason.
  void find_holder(std::size_t task) {
    for (const std::string& before : tasks_[task].after) {
      if (const auto at = by_id_.find({tasks_[task].run, before}); at != by_id_.end()) {
        for (const std::size_t attempt : at->second) consider(task, attempt, false);
      }
    }
    for (const std::size_t attempt : by_id_[{tasks_[task].run, tasks_[task].id}]) {
      if (tasks_[attempt].has_failed) consider(task, attempt, false);
    }
    const auto& of_robot = by_robot_[tasks_[task].robot];
    for (const std::size_t other : of_robot) {
      if (tasks_[other].run == tasks_[task].run) consider(task, other, true);
    }
    const double ready_s = out_[task].holder ? tasks_[*out_[task].holder].end_s : tasks_[task].since_s;
    for (const std::size_t other : of_robot) {
      if (tasks_[other].run != tasks_[task].run && tasks_[other].end_s > ready_s) consider(task, other, true);
    }
    const auto& holder = out_[task].holder;
    const bool is_kept = holder && tasks_[*holder].run != tasks_[task].run;
    if (is_kept) out_[task].kept_s = tasks_[*holder].end_s - ready_s;
  }

  void mark_critical(std::size_t run) {
    const auto known_end = [run](const PlayedTask& one) { return one.is_open || one.run != run ? -1 : one.end_s; };
    const auto last = std::ranges::max_element(tasks_, {}, known_end);
    if (last == tasks_.end() || last->is_open || last->run != run) return;
    std::optional<std::size_t> at = static_cast<std::size_t>(last - tasks_.begin());
    while (at && !out_[*at].is_critical) {
      out_[*at].is_critical = true;
      at = out_[*at].more_s > kLongestHandOver_s ? std::nullopt : out_[*at].holder;
    }
  }

  const std::vector<PlayedTask>& tasks_;
  std::vector<TaskWait> out_;
  std::size_t runs_ = 0;
  std::map<std::pair<std::size_t, std::string>, std::vector<std::size_t>> by_id_;  ///< by run and id
  std::map<std::string, std::vector<std::size_t>> by_robot_;
};

}  // namespace

std::vector<TaskWait> waits_of(const std::vector<PlayedTask>& tasks) {
  return Waits(tasks).find();
}

}  // namespace trb
