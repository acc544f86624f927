// Who can do what another robot was to do: candidates, and why the others are none.
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
  std::vector<std::string> except;  ///< ids that are out of the question: the faulty robot, who was tried already
};

struct TaskCandidates {
  std::string task;
  std::vector<std::string> robots;  ///< by id
};

struct Unsuitable {
  std::string robot;
  std::string why;  ///< "is OFFLINE; has no skill 'fetch' (task t4)", kMaxWhy bytes at most
};

constexpr std::size_t kMaxWhy = 400;
constexpr std::size_t kMaxUnsuitable = 1000;

struct Candidates {
  std::vector<std::string> robots;  ///< who can do all of the tasks, by id
  /// If nobody can do all: for each task, in the order of the needs, who can do it. All of them have somebody if the
  /// tasks can be done by several between them.
  std::vector<TaskCandidates> by_task;
  /// Robots that have some skill or capability that is needed, and yet fall out; by id, kMaxUnsuitable at most.
  std::vector<Unsuitable> unsuitable;
  std::size_t others = 0;  ///< robots that have nothing of what is needed, or of which there is no room to tell

  /// The tasks can be done: by one, or by several between them.
  [[nodiscard]] bool cover() const;
};

/// Robots that are fit and able to do all of the tasks: each skill, capability, parameter, value and place.
Candidates find_candidates(const Fleet& fleet, const Needs& needs);

/// Who is fit and able to do all of these, by id.
std::vector<std::string> find_able(const Fleet& fleet, const std::vector<TaskNeed>& needs,
                                   const std::vector<std::string>& except);

/// Why the robot cannot do the task, whether fit or not; empty if it can.
std::string why_unable(const RobotRecord& robot, const TaskNeed& need);

}  // namespace trb::resilience
