// Robots and messages for the tests of the capability database.
#pragma once

#include <string>
#include <vector>

#include "services/resilience/core/candidates.hpp"

namespace trb::resilience {

inline UtcTime at_second(std::int64_t second) {
  return {1'700'000'000'000'000'000 + second * 1'000'000'000};
}

inline SkillInfo go_to_skill() {
  return {"go_to", "mobile", {{"place", "place", true, ""}}, true, 120};
}

inline NodeProfile mobile_robot() {
  NodeProfile profile;
  profile.framework = "ridgeback";
  profile.mode = "ros";
  profile.transport = "ros";
  profile.capabilities = {"mobile"};
  profile.skills = {go_to_skill()};
  profile.places = {"dock", "table1"};
  profile.robot = "ONLINE";
  profile.frame = {1, 0, 0, 0};
  return profile;
}

/// It moves and carries.
inline NodeProfile carrier() {
  NodeProfile profile = mobile_robot();
  profile.capabilities = {"mobile", "carry"};
  profile.skills.push_back({"load_out",
                            "carry",
                            {{"height", "number", false, "m", {0, 1.5}}, {"side", "text", false, "", {}, {"l", "r"}}},
                            false,
                            60});
  return profile;
}

inline Route route_of(const std::string& id, const NodeProfile& profile, const std::string& state = "ONLINE") {
  Route route;
  route.id = id;
  route.state = state;
  route.profile = profile;
  return route;
}

/// A row of the table with another profile; whether the robot is reached stays the same.
inline Result<bool> tell_profile(Fleet& fleet, const std::string& id, const NodeProfile& profile, UtcTime now) {
  const RobotRecord* robot = fleet.find(id);
  const bool reached = robot != nullptr && robot->reached;
  return fleet.on_route(route_of(id, profile, reached ? "ONLINE" : "CONNECTION_BROKEN"), now);
}

inline TaskNeed drive(const std::string& place) {
  return {"drive", "go_to", {}, {{"place", Value{place}}}, {}};
}

inline TaskNeed load(Value::Object arguments = {}) {
  return {"load", "load_out", {}, std::move(arguments), {}};
}

using Ids = std::vector<std::string>;

/// The reason for which that robot is no candidate; empty if none is given.
inline std::string why(const Candidates& candidates, const std::string& robot) {
  for (const Unsuitable& one : candidates.unsuitable) {
    if (one.robot == robot) return one.why;
  }
  return {};
}

}  // namespace trb::resilience
