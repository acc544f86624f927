// ROS 1 messages between JSON and the wire (ROS wiki, "msg", section 4: little-endian, no padding, u32 lengths).
#pragma once

#include <string>
#include <vector>

#include "common/base/bytes.hpp"
#include "common/base/result.hpp"
#include "proto/value.hpp"
#include "services/ros-bridge/core/message_type.hpp"

namespace trb::ros {

/// Largest message on the wire, in bytes.
constexpr std::size_t kMaxMessage = 1U << 20U;

/// An object with the message's fields (those left out are zero), or a flat list of all its values in the order of the
/// fields, if no part's length is free. A message of one value is also taken as that value alone.
///
/// time and duration: {"secs", "nsecs"}; in a flat list two values. Arrays of uint8 (also char): a list, or their bytes
/// as base64. 64-bit integers that JSON cannot write are text. Text that is no UTF-8: {"base64": "..."}.
/// A number that is not finite ("nan", "inf") is refused: nothing that a robot is told may be one.
///
/// Errors: bad_value, missing, unknown_key, too_large; each names the field, as pose.position.x or points[3].y.
Result<Bytes> to_wire(const RosType& type, const Value& json);

/// An object with every field, in such words that to_wire gives the same bytes; but a number that is not finite is
/// null: the robot has not measured it (sensor_msgs: NaN is "unmeasured"). Errors: malformed (ends too early or too
/// late, names the field), too_large.
/// With `paths` only the fields in which they begin: "info.width" is in "info". What is left out may be of any size.
Result<Value> to_json(const RosType& type, BytesView wire, const std::vector<std::string>& paths = {});

}  // namespace trb::ros
