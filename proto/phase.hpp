// The phase of Equation 12 that a message belongs to, by its subtype.
#pragma once

#include <array>
#include <string_view>

#include "proto/field.hpp"

namespace trb {

/// The terms of Equation 12. `upkeep` is what the paper does not count: keep-alives, lists, signatures, proofs of
/// delivery.
enum class CostPhase : unsigned char { boot = 0, identification, devices, task, forward, sensor, fail, upkeep };
constexpr auto enum_names(CostPhase) {
  return std::array<std::string_view, 8>{"boot",    "identification", "devices", "task",
                                         "forward", "sensor",         "fail",    "upkeep"};
}

/// True for every typed subtype that is sent (Travel::phase).
bool has_phase(std::string_view subtype);

/// The phase of a message by its subtype; a user's own subtype counts as `task`.
CostPhase phase_of(std::string_view subtype);

}  // namespace trb
