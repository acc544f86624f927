// Scenarios that run beside a job's own on the same robots, as a job says them.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "common/fleet/object_reader.hpp"
#include "proto/value.hpp"

namespace trb::simulation {

constexpr std::size_t kMostBeside = 9;

struct JobRun {
  const Value* scenario = nullptr;  ///< in the job; what is in it is not looked at here
  double after_s = 0;               ///< it is submitted so long after the first run
  std::string path;                 ///< "beside[1].scenario"
};

/// Key `beside`, optional: [{"scenario", "after" (0)}], nine at most. Every fault is added, by its key; one without a
/// scenario is left out.
std::vector<JobRun> read_beside(ObjectReader& reader);

}  // namespace trb::simulation
