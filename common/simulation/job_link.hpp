// The network between simulated computers, as a job says it.
#pragma once

#include "common/fleet/object_reader.hpp"
#include "common/simulation/link_kind.hpp"

namespace trb::simulation {

constexpr std::size_t kMaxMeasured = 10'000;

/// Key `link`, optional ("lan"): a kind's name, or {"delay_s", "deviation_s"} or {"delays_s": [measured ones]}, each
/// with optional "loss" (a part of the packets: 0, or 1e-6 to 0.5) and "bytes_a_second". One way, in seconds. Every
/// fault is added, by its key.
LinkKind read_link(ObjectReader& reader);

}  // namespace trb::simulation
