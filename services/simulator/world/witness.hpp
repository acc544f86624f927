// What really happened of a run at the robots, whatever anybody says of it.
#pragma once

#include <algorithm>
#include <cstdint>
#include <map>
#include <optional>
#include <set>
#include <string>

#include "proto/bodies/robot.hpp"

namespace trb::world {

class Witness {
 public:
  void on_begin(const std::string& robot, const AttemptKey& key, double at_s) {
    moved_s_ = at_s;
    ++begun_[key];
    at_work_[robot] = key;
    if (!first_s_) first_s_ = at_s;
  }
  /// The robot began a task of another run.
  void on_left(const std::string& robot) { at_work_.erase(robot); }
  /// One robot began a task that another is still at.
  void on_double(const std::string& task) { doubles_.insert(task); }
  [[nodiscard]] const std::set<std::string>& doubles() const { return doubles_; }
  /// The task that the robot began last, if it has not done it.
  [[nodiscard]] std::string task_of(const std::string& robot) const {
    const auto at = at_work_.find(robot);
    return at == at_work_.end() ? "" : at->second.task;
  }
  void on_end(const std::string& robot, double at_s) {
    const auto at = at_work_.find(robot);
    if (at == at_work_.end()) return;
    ++done_[at->second.task];
    ended_[robot] = {at->second.task, at_s};
    moved_s_ = last_s_ = at_s;
    at_work_.erase(at);
  }
  /// Its node's processes end: how a task ended that was under way, or has just ended, nobody can know.
  /// `commit_s`: what its disk takes to write; it writes something else first, perhaps.
  void on_kill(const std::string& robot, double at_s, double commit_s) {
    const double just_s = std::max(0.1, 3 * commit_s);
    if (const auto at = at_work_.find(robot); at != at_work_.end()) unknown_.insert(at->second.task);
    if (const auto at = ended_.find(robot); at != ended_.end() && at_s - at->second.second < just_s)
      unknown_.insert(at->second.first);
  }
  /// Tasks that were done, and whose nodes must know it.
  [[nodiscard]] std::set<std::string> provable() const {
    std::set<std::string> out;
    for (const auto& [task, times] : done_) out.insert(task);
    for (const std::string& task : unknown_) out.erase(task);
    return out;
  }
  /// How often the task was done to its end.
  [[nodiscard]] std::uint32_t done(const std::string& task) const {
    const auto at = done_.find(task);
    return at == done_.end() ? 0 : at->second;
  }
  [[nodiscard]] std::size_t tasks_done() const { return done_.size(); }
  [[nodiscard]] const std::map<AttemptKey, std::uint32_t>& begun() const { return begun_; }
  /// When a robot last began or ended a task.
  [[nodiscard]] double moved_s() const { return moved_s_; }
  /// From the first task's begin to the last one's end; 0: none was done.
  [[nodiscard]] double makespan_s() const { return done_.empty() ? 0 : last_s_ - *first_s_; }

 private:
  std::map<AttemptKey, std::uint32_t> begun_;
  std::map<std::string, std::uint32_t> done_;
  std::map<std::string, AttemptKey> at_work_;
  std::map<std::string, std::pair<std::string, double>> ended_;  ///< by robot: its last task, and when
  std::set<std::string> unknown_, doubles_;
  std::optional<double> first_s_;
  double last_s_ = 0, moved_s_ = 0;
};

}  // namespace trb::world
