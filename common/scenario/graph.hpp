// A scenario as a graph: what is ready, what follows, what is final, and the blocks of Equation 8.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "common/base/bytes.hpp"
#include "common/base/result.hpp"
#include "proto/bodies/run.hpp"

namespace trb {

/// A task's place in Scenario::tasks.
using TaskIndex = std::uint16_t;

constexpr std::uint32_t kMaxRetries = 16;
constexpr double kMinRetryAfterS = 0.1;
constexpr double kMaxRetryAfterS = 3600;
constexpr double kMinStartWithinS = 0.1;
constexpr double kMaxStartWithinS = 86400;

/// Checks what can be checked without knowing the robots: 1 to kMaxTasks tasks, valid and unique ids, a robot or
/// required capabilities, predecessors that exist and occur once, no cycle, at most one condition for each, retries
/// within bounds, values of predecessors. Errors: too_large, bad_value, duplicate; each names the task.
Status check_graph(const Scenario& scenario);

/// The direct successors of every task, ascending. The scenario must have passed check_graph.
std::vector<std::vector<TaskIndex>> successors_of(const Scenario& scenario);

/// The task whose actor evaluates this one's condition: its lowest-numbered predecessor, or itself if it has none.
TaskIndex chooser_of(const Scenario& scenario, TaskIndex task);

/// True if every direct predecessor is final.
bool predecessors_final(const Task& task, const std::vector<bool>& final_tasks);

/// Baton::final_tasks: task i is bit i%8 of byte i/8; bytes at the end without any are left out.
Bytes to_bitmap(const std::vector<bool>& final_tasks);

/// The inverse, for a scenario of `tasks` tasks; a shorter bitmap means "not final" for the rest. Errors: too_large
/// (bits beyond the last task).
Result<std::vector<bool>> from_bitmap(BytesView bitmap, std::size_t tasks);

/// Equation 8 of the paper: the blocks of at least two consecutive tasks of one actor, in the order of the file.
struct Blocks {
  std::size_t k = 0;      ///< how many blocks
  std::size_t sum_m = 0;  ///< how many tasks they have together
  bool operator==(const Blocks&) const = default;
};
Blocks blocks_of(const std::vector<std::string>& robots);

/// N_task - sum m_j + k - 1: how often the actor changes, which is the number of forward messages.
std::size_t forward_messages(const std::vector<std::string>& robots);

}  // namespace trb
