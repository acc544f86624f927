// `trb simulate --one-less`: what a job has of a robot, taken out with it.
#pragma once

#include <string>

#include "proto/value.hpp"

namespace trb::cli {

/// A job's keys without what concerns this robot alone: its faults, sensors' values and right to relay; of a partition
/// its place. Without `trace`, too: that file is of the whole fleet; and
/// without `alone`: what the runs take at once is asked for. `robots`: how many the fleet has left.
Value::Object without_robot(const Value::Object& job, const std::string& robot, std::size_t robots);

}  // namespace trb::cli
