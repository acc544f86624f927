// The files of a new node's folder, and where a person finds what goes into them.
#pragma once

#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "common/base/result.hpp"

namespace trb::cli {

/// A kind of robot that `trb node new --like` knows.
struct RobotKind {
  std::string_view like;         ///< "ur"
  std::string_view maker;        ///< for people
  std::string_view framework;    ///< its name in commands.json and profile.json
  std::string_view description;  ///< of config/robots, copied into the folder
  std::string_view address_at;   ///< where the maker's controller shows its address
  std::string_view prepare;      ///< what the robot itself needs
  bool has_ros = false;          ///< its node has a ros-bridge
};
std::span<const RobotKind> robot_kinds();
/// Errors: bad_value with the nearest, or all, as the hint.
Result<RobotKind> robot_kind(const std::string& like);

/// What a person has said of it.
struct NewNode {
  std::string id;
  RobotKind kind;
  std::string robot_address;  ///< IPv4
  std::string robot_side;     ///< this computer's address or interface towards the robot; empty: the fleet's network
  std::string fleet_side;     ///< interface or address on the fleet's network
  std::string told_faults_at = {};  ///< of a virtual robot: HOST:PORT for trb robot fault; empty: none
};

/// A cloud node needs no more than this.
struct NewCloud {
  std::string id;
  std::string fleet_side;  ///< interface or address on the fleet's network
  std::string page = {};   ///< HOST:PORT of the page; empty: it has none
};

/// Each value with a line that says what it is and where to find it.
std::string node_json_of(const NewNode& node);
std::string node_json_of(const NewCloud& cloud);
std::string network_json_of(const std::string& fleet_side);
std::string cloud_json_of(const NewCloud& cloud);

}  // namespace trb::cli
