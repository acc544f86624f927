#include "services/resilience/core/robot_state.hpp"

#include <doctest/doctest.h>

#include <cmath>

#include "services/resilience/test/fleet_fixture.hpp"

using namespace trb;
using namespace trb::resilience;

namespace {

RobotRecord robot_that_tells(const std::string& mode, const std::string& transport, const std::string& name,
                             const std::string& value) {
  RobotRecord robot;
  robot.profile.is = mobile_robot();
  robot.profile.is.mode = mode;
  robot.profile.is.transport = transport;
  robot.values[name] = {value, at_second(3)};
  return robot;
}

std::optional<double> charge(const std::string& mode, const std::string& transport, const std::string& name,
                             const std::string& value) {
  const auto told = charge_of(robot_that_tells(mode, transport, name, value));
  return told ? std::optional(told->is) : std::nullopt;
}

std::optional<HallPoint> place(const FrameInfo& frame, const std::string& value) {
  RobotRecord robot = robot_that_tells("ros", "ros", "position", value);
  robot.profile.is.frame = frame;
  const auto told = position_of(robot);
  return told ? std::optional(told->is) : std::nullopt;
}

}  // namespace

TEST_CASE("the charge is percent by what is known of each robot's battery") {
  CHECK(charge("ros", "ros", "battery", "0.5") == 50);
  CHECK(charge("ros", "ros", "battery", "1") == 100);
  CHECK(charge("direct", "udp-at", "battery", "87") == 87);
  CHECK(charge("interpreter", "", "battery", "87.5") == 87.5);
  CHECK(charge("interpreter", "lines", "battery", "\"87.5\"") == 87.5);
  CHECK(charge("direct", "arcos", "state_of_charge", "61.1") == 61.1);
}

TEST_CASE("what cannot be percent is unknown, not guessed") {
  CHECK_FALSE(charge("direct", "arcos", "battery", "12.4"));  // volts
  CHECK_FALSE(charge("direct", "modbus", "battery", "50"));   // its unit is not defined
  for (const char* value : {"87", "-0.1", "null", "true", "[0.5]", "{}", "\"full\"", "nan", "\"nan\"", "inf", ""}) {
    CAPTURE(value);
    CHECK_FALSE(charge("ros", "ros", "battery", value));
  }
}

TEST_CASE("state_of_charge wins over battery, unless it says nothing") {
  RobotRecord robot = robot_that_tells("ros", "ros", "battery", "0.5");
  robot.values["state_of_charge"] = {"40", at_second(7)};
  CHECK(charge_of(robot) == Reported<double>{40, at_second(7)});
  robot.values["state_of_charge"].is = "null";
  CHECK(charge_of(robot) == Reported<double>{50, at_second(3)});
}

TEST_CASE("a robot is asked for its charge by the word whose answer can be read") {
  const auto asked = [](const std::string& mode, const std::string& transport) {
    return charge_request(robot_that_tells(mode, transport, "", "").profile.is);
  };
  CHECK(asked("ros", "ros") == "battery");
  CHECK(asked("direct", "udp-at") == "battery");
  CHECK(asked("interpreter", "") == "battery");
  CHECK(asked("direct", "arcos") == "state_of_charge");
  RobotRecord robot = robot_that_tells("ros", "ros", "", "");
  robot.profile.is.sensors = {"state_of_charge"};
  CHECK(charge_request(robot.profile.is) == "state_of_charge");
}

TEST_CASE("a position is told in the robot's frame and unit, and known in the hall's") {
  CHECK(place({1, 0, 0, 0}, "[2, 3, 0.5]") == HallPoint{2, 3});
  CHECK(place({1, 0, 0, 0}, "\"2 3 0.5\"") == HallPoint{2, 3});
  CHECK(place({1, 0, 0, 0}, "2.5, 3") == HallPoint{2.5, 3});
  CHECK(place({1, 0, 0, 0}, R"({"x": 2, "y": 3, "z": 0})") == HallPoint{2, 3});
  const auto turned = place({1000, 1, 1, M_PI / 2}, "[2000, 0, 90]");
  REQUIRE(turned);
  CHECK(turned->x == doctest::Approx(1));
  CHECK(turned->y == doctest::Approx(3));
}

TEST_CASE("a position that nobody can place in the hall is unknown") {
  CHECK_FALSE(place({0, 0, 0, 0}, "[2, 3]"));  // its node does not report its frame
  for (const char* value : {"[2]", "2", "null", R"(["a", "b"])", R"({"x": 1})", "[1e300, 0]", "nan nan", "two three"}) {
    CAPTURE(value);
    CHECK_FALSE(place({1, 0, 0, 0}, value));
  }
}

TEST_CASE("a robot that does not move stands at its origin, if that was said") {
  RobotRecord robot = robot_that_tells("direct", "tcp-text", "position", "[0.1, 1.2, 1, 0, 0, 0]");  // its joints
  robot.profile.is.capabilities = {"grab"};
  robot.profile.at = at_second(1);
  CHECK_FALSE(position_of(robot));
  robot.profile.is.frame = {1000, 5.5, 1, 0};
  CHECK(position_of(robot) == Reported<HallPoint>{{5.5, 1}, at_second(1)});
}

TEST_CASE("the mode is the robot's own word") {
  CHECK(mode_of(robot_that_tells("direct", "c3", "operating_mode", "\"#AUT\""))->is == "#AUT");
  CHECK(mode_of(robot_that_tells("direct", "tcp-text", "robot_mode", "7"))->is == "7");
  CHECK_FALSE(mode_of(robot_that_tells("direct", "tcp-text", "joints", "7")));
}
