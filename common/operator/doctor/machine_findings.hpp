// Findings about the node's computer: the disk that its folder is on, and the clock.
#pragma once

#include "common/operator/doctor/diagnosis.hpp"

namespace trb::op {

/// Less than this is told before no file can be made any more (kFullFiles).
inline constexpr std::uint64_t kFewFiles = 1'000;

/// A disk that takes nothing more is a problem, one with little room a note; so is a clock that nothing sets.
void add_machine_findings(const Observed& seen, std::vector<Finding>& out);

}  // namespace trb::op
