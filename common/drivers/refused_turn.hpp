// The fault of a robot that refuses to stop, or to go on after a stop: the whole robot's, until it does so.
#pragma once

#include <string>
#include <utility>

#include "common/drivers/driver.hpp"

namespace trb::drivers {

/// What the text of a halt's refusal ends with if the robot may have taken a part of it.
constexpr const char* kMayStand = "; it may stand in its stop: stop and release it";

/// `stop`: to stop; else to go on.
inline std::string refused_turn_cause(bool stop) {
  return stop ? "stop refused" : "release refused";
}
inline FaultSaid refused_turn(bool stop, std::string text) {
  return {"", Severity::critical, std::move(text), refused_turn_cause(stop), false};
}
/// It has done it.
inline FaultOver refused_turn_over(bool stop) {
  return {refused_turn_cause(stop)};
}

}  // namespace trb::drivers
