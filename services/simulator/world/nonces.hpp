// What a world draws in place of the system's random bytes, so that one seed gives the same frames.
#pragma once

#include <cstdint>

namespace trb::world {

/// From now on the process's random bytes (a relayed message's nonce) follow from `seed`, until the next call. Before
/// the first one they are the system's. In world/signatures.cpp.
void draw_nonces_from(std::uint64_t seed);

}  // namespace trb::world
