// When each task of a played run began and ended, and what it waited for, as a table.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "common/scenario/critical_path.hpp"

namespace trb::cli {

/// "12.3".
std::string seconds_text(double value);

/// The rows of that run, in the order given; runs are counted from 1 in the text. Tasks of the critical path have a *.
void print_waits(const std::vector<PlayedTask>& tasks, std::size_t run = 0);
/// What such a table cannot say.
void print_waits_key(const std::vector<PlayedTask>& tasks);

}  // namespace trb::cli
