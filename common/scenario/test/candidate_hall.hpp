#pragma once

#include <string>
#include <utility>
#include <vector>

#include "common/scenario/definition.hpp"

namespace trb {

/// A robot that drives to its places.
inline NodeProfile cart(std::vector<std::string> places = {"dock", "table1"}) {
  NodeProfile out;
  out.robot = "ONLINE";
  out.capabilities = {"mobile"};
  out.places = std::move(places);
  out.skills = {
      {"go_to", "mobile", {{"place", "place", true, ""}, {"speed", "number", false, "m/s", {0.1, 1}}}, true, 60}};
  return out;
}

/// A cart that carries, too.
inline NodeProfile carrier() {
  NodeProfile out = cart();
  out.capabilities.emplace_back("carry");
  out.skills.push_back({"load_out", "carry", {{"side", "text", true, "", {}, {"left", "right"}}}, false, 60});
  return out;
}

/// A task for whoever has these capabilities.
inline Task late(std::vector<std::string> capabilities, std::string skill = "go_to",
                 std::string data = R"({"place":"dock"})") {
  Task out;
  out.id = "t";
  out.requires_ = std::move(capabilities);
  out.skill = std::move(skill);
  out.data = std::move(data);
  return out;
}

}  // namespace trb
