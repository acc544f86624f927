// A robot's skills as JSON Schema, for forms and for programs that check before they send.
#pragma once

#include "proto/bodies/link.hpp"
#include "proto/value.hpp"

namespace trb::gateway {

/// By skill: the schema (draft 2020-12) of its parameters. A number's unit is `x-unit`; a place is one of the robot's
/// places.
Value skill_schemas(const NodeProfile& profile);

}  // namespace trb::gateway
