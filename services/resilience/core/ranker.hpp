// Ranks candidates, each with its parts: scores relative to each other (the AHP's), merits relative to the best
// possible.
#pragma once

#include <string>
#include <vector>

#include "proto/bodies/resilience.hpp"
#include "services/resilience/core/proposals.hpp"

namespace trb::resilience {

struct Ranked {
  std::string robot;
  double score = 0;
  double merit = 0;
  std::vector<CriterionPart> parts;
  std::string note;
};

/// The input of a ranking.
struct Ranking {
  const Fleet& fleet;
  const HallPlaces& places;
  const Criteria& criteria;
  UtcTime now;
};

/// Best first, `most` at most; their scores sum to 1.
std::vector<Ranked> rank(const Ranking& of, const std::vector<TaskNeed>& needs, std::vector<std::string> robots,
                         std::size_t most);

/// With which weight of a criterion another of these robots would be first; its siblings are scaled in proportion.
std::vector<WeightFlip> weight_flips(const Ranking& of, const std::vector<TaskNeed>& needs,
                                     std::vector<std::string> robots);

}  // namespace trb::resilience
