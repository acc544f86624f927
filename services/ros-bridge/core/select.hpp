// The parts of a ROS message that commands.json asks for.
#pragma once

#include <string>
#include <vector>

#include "common/base/result.hpp"
#include "proto/value.hpp"

namespace trb::ros {

/// The value at each path ("pose.position.x", "ranges[3]"): one is given as it is, several as a list, none: the whole.
/// Errors: bad_value, naming the path.
Result<Value> select(const Value& message, const std::vector<std::string>& paths);

}  // namespace trb::ros
