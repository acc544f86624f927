// The ranked ways out of an alert: who could take the tasks over, and why in this order.
#pragma once

#include <map>
#include <string>
#include <vector>

#include "common/config/resilience_file.hpp"
#include "proto/bodies/resilience.hpp"
#include "services/resilience/core/candidates.hpp"
#include "services/resilience/core/watched_run.hpp"

namespace trb::resilience {

constexpr std::size_t kMaxProposals = 64;
constexpr std::size_t kMaxUnfit = 64;

struct Ways {
  std::vector<Proposal> proposals;  ///< best first
  std::vector<Unfit> unfit;
};

/// Where the places are: places.json of the node's folder, the hall's frame.
using HallPlaces = std::map<std::string, HallPoint>;

/// What the tasks ask of whoever takes them over. Error: malformed (a task's data).
Result<Needs> needs_of(const WatchedRun& run, const std::vector<std::size_t>& tasks, const std::string& robot);

/// One robot for all of them if there is one; else several between them, as one proposal; else nobody.
Ways find_ways(const Fleet& fleet, const Needs& needs, const HallPlaces& places, const ReplacementWeights& weights,
               UtcTime now);

}  // namespace trb::resilience
