#include "common/scenario/cycles.hpp"

#include <algorithm>

namespace trb {
namespace {

constexpr std::size_t kMostTold = 8;

/// Depth-first search from task to predecessor, with a stack of its own: a scenario may be a chain of a thousand tasks.
class Search {
 public:
  explicit Search(const Scenario& scenario) : tasks_(scenario.tasks), marks_(tasks_.size(), Mark::unseen) {}

  std::vector<std::vector<std::size_t>> run() && {
    for (std::size_t i = 0; i < tasks_.size(); ++i) {
      if (marks_[i] == Mark::unseen) descend(i);
    }
    return std::move(cycles_);
  }

 private:
  enum class Mark : std::uint8_t { unseen, on_path, done };
  struct Step {
    std::size_t task;
    std::size_t next = 0;  ///< the predecessor to look at next
  };

  void descend(std::size_t start) {
    enter(start);
    while (!path_.empty()) {
      Step& step = path_.back();
      const auto& after = tasks_[step.task].after;
      if (step.next == after.size()) {
        marks_[step.task] = Mark::done;
        path_.pop_back();
        continue;
      }
      const std::size_t next = after[step.next++];
      if (marks_[next] == Mark::unseen) {
        enter(next);
      } else if (marks_[next] == Mark::on_path && cycles_.size() < kMostTold) {
        add_cycle(next);
      }
    }
  }

  void enter(std::size_t task) {
    marks_[task] = Mark::on_path;
    path_.push_back({task});
  }

  /// The path leads from a task to what it waits for: read backwards it is the order of running.
  void add_cycle(std::size_t first) {
    std::vector<std::size_t> cycle;
    for (auto at = path_.rbegin(); at != path_.rend(); ++at) {
      cycle.push_back(at->task);
      if (at->task == first) break;
    }
    // Begin with the task that comes first in the file, wherever the search began.
    std::rotate(cycle.begin(), std::min_element(cycle.begin(), cycle.end()), cycle.end());
    cycles_.push_back(std::move(cycle));
  }

  const std::vector<Task>& tasks_;
  std::vector<Mark> marks_;
  std::vector<Step> path_;
  std::vector<std::vector<std::size_t>> cycles_;
};

}  // namespace

std::vector<std::vector<std::size_t>> find_cycles(const Scenario& scenario) {
  return Search(scenario).run();
}

}  // namespace trb
