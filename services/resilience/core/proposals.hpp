// The ranked ways out of an alert: which robots could take the tasks over, and why in this order.
#pragma once

#include <map>
#include <string>
#include <vector>

#include "proto/bodies/resilience.hpp"
#include "services/resilience/core/criteria.hpp"
#include "services/resilience/core/watched_run.hpp"

namespace trb::resilience {

constexpr std::size_t kMaxProposals = 64;
constexpr std::size_t kMaxUnfit = 64;

struct Ways {
  std::vector<Proposal> proposals;  ///< best first; so many that an alert with them can be read again
  std::vector<Unfit> unfit;
  std::vector<std::string> bounded;  ///< robots that only a bound excludes: their values may be old
};

/// Positions of the places: places.json of the node's folder, in the hall's frame.
using HallPlaces = std::map<std::string, HallPoint>;

/// What the tasks require of the robot that takes them over. Error: malformed (a task's data).
Result<Needs> needs_of(const WatchedRun& run, const std::vector<std::size_t>& tasks, const std::string& robot);

/// One robot for all tasks if there is one; else several between them, as one proposal; else none.
Ways find_ways(const Fleet& fleet, const Needs& needs, const HallPlaces& places, const Criteria& criteria, UtcTime now);

/// The first place among the parameters that the robot's skills take as places.
std::optional<HallPoint> place_of(const RobotRecord& robot, const std::vector<TaskNeed>& needs,
                                  const HallPlaces& places);

}  // namespace trb::resilience
