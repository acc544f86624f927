// Which robots can do another robot's tasks (candidates), and why the others cannot.
#pragma once

#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "common/scenario/task_need.hpp"
#include "services/resilience/core/fleet.hpp"

namespace trb::resilience {

struct Needs {
  std::vector<TaskNeed> tasks;
  std::vector<std::string> except;  ///< excluded ids: the faulty robot, and robots that were tried already
};

struct TaskCandidates {
  std::string task;
  std::vector<std::string> robots;  ///< by id
};

struct Unsuitable {
  std::string robot;
  std::string why;  ///< "is OFFLINE; has no skill 'fetch' (tasks t4, t6)", kMaxWhy bytes at most
};

constexpr std::size_t kMaxWhy = 255;  ///< what an alert takes
constexpr std::size_t kMaxUnsuitable = 1000;

struct Candidates {
  std::vector<std::string> robots;  ///< robots that can do all of the tasks, by id
  /// If no robot can do all: for each task, in the order of the needs, the robots that can do it. If none of the lists
  /// is empty, several robots can do the tasks between them.
  std::vector<TaskCandidates> by_task;
  /// Robots that have some of the skills or capabilities and still cannot do it; by id, kMaxUnsuitable at most.
  std::vector<Unsuitable> unsuitable;
  std::size_t others = 0;  ///< robots that have none of them, or for which there is no room

  /// Can the tasks be done, by one robot or by several between them?
  [[nodiscard]] bool cover() const;
};

/// Robots that are fit and able to do all of the tasks: each skill, capability, parameter, value and place.
Candidates find_candidates(const Fleet& fleet, const Needs& needs);

/// Robots that are fit and able to do all of these, by id.
std::vector<std::string> find_able(const Fleet& fleet, const std::vector<TaskNeed>& needs,
                                   const std::vector<std::string>& except);

/// Why the robot cannot do the task, whether fit or not; empty if it can.
std::string why_unable(const RobotRecord& robot, const TaskNeed& need);

}  // namespace trb::resilience
