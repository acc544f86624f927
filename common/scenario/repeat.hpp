// A scenario's tasks several times over.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "proto/bodies/run.hpp"

namespace trb {

constexpr std::uint32_t kMaxRounds = 1000;

/// A task's id in a round: "ID" in the first, then "ID#2", "ID#3" and so on. No file has a '#' in an id.
std::string round_id(const std::string& id, std::uint32_t round);

/// The id of the same task in the first round.
std::string first_id(const std::string& id);

/// An id, with a round behind it or without; 64 bytes at most.
bool is_valid_task_id(std::string_view id);

/// Is it a task of a later round, the same as one that stands in the file?
bool is_repetition(std::string_view id);

/// The tasks round by round. What a task waits for and takes values from stays in its round; those that wait for
/// nothing wait, from the second round on, for all of the last round's tasks that nobody waits for. The tasks must
/// have passed check_graph.
std::vector<Task> repeat_tasks(const std::vector<Task>& tasks, std::uint32_t rounds);

}  // namespace trb
