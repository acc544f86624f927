#pragma once

#include "proto/bodies/link.hpp"
#include "proto/bodies/run_view.hpp"
#include "proto/value.hpp"

namespace trb::op {

/// A run as JSON: its view; for each task the mode and transport of its robot, from the routing table; and the blocks
/// of Equation 8 ("blocks_k", "blocks_sum_m").
Value run_report(const RunView& view, const RouteTable& table);

}  // namespace trb::op
