// What a robot's own implementation of proto/FIELD_CHANNEL.md is tried with, case by case.
#pragma once

#include <vector>

#include "services/cli/conform/play.hpp"

namespace trb::cli::conform {

struct Case {
  const char* name;
  const char* tries;
  const char* section;  ///< of proto/FIELD_CHANNEL.md
  void (*play)(Play&);
};

/// In the order in which they are played.
std::vector<Case> all_cases();

// Its parts, a file each.
std::vector<Case> field_cases();
std::vector<Case> order_cases();

}  // namespace trb::cli::conform
