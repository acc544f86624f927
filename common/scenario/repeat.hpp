// Repeats a scenario's tasks in several rounds.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "proto/bodies/run.hpp"

namespace trb {

constexpr std::uint32_t kMaxRounds = 1000;

/// A task's id in a round: "ID" in the first, then "ID#2", "ID#3" and so on. Ids in a file have no '#'.
std::string round_id(const std::string& id, std::uint32_t round);

/// The id of the same task in the first round.
std::string first_id(const std::string& id);

/// An id, with or without a round; 64 bytes at most.
bool is_valid_task_id(std::string_view id);

/// True for a task of a later round, whose original is in the file.
bool is_repetition(std::string_view id);

/// The tasks round by round. A task's predecessors and sources of values are those of its own round; from the second
/// round on, a task without predecessors follows all tasks of the last round that have no successor. The tasks must
/// have passed check_graph.
std::vector<Task> repeat_tasks(const std::vector<Task>& tasks, std::uint32_t rounds);

}  // namespace trb
