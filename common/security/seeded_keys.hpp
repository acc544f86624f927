// Keys from a number, for simulations: the same number gives the same keys. Whoever guesses the number has them, so no
// real node may use them.
#pragma once

#include <cstdint>

#include "common/security/keys.hpp"

namespace trb {

SigningKey seeded_signing_key(std::uint64_t seed);
LinkKey seeded_link_key(std::uint64_t seed);

}  // namespace trb
