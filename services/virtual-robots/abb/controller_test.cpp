#include "services/virtual-robots/abb/controller.hpp"

#include <doctest/doctest.h>

using namespace trb::virtual_robots::abb;

TEST_CASE("a string ends with its # or after 80 characters") {
  std::string bytes = "2 1 2";
  CHECK_FALSE(take_string(bytes));
  bytes += " #4 #";
  CHECK(*take_string(bytes) == "2 1 2 #");
  CHECK(*take_string(bytes) == "4 #");
  bytes = std::string(100, '1');
  CHECK(take_string(bytes)->size() == 80);
  CHECK(bytes.size() == 20);
}

TEST_CASE("a move blocks until it has ended; its answer is the end") {
  Controller robot;
  CHECK_FALSE(robot.program("2 60 0 0 0 30 0 #", 0));
  CHECK(robot.blocked());
  CHECK_FALSE(robot.advance(0.5));
  CHECK(robot.service("4 #", 0.5) == "4 1 30.00 0.00 0.00 0.00 30.00 0.00#");
  CHECK(robot.service("90 #", 0.5) == "90 1 0 1 1 0#");
  CHECK(*robot.advance(1.0) == "2 1#");
  CHECK(*robot.program("4 #", 2) == "4 1 60.00 0.00 0.00 0.00 30.00 0.00#");
}

TEST_CASE("what is refused says why") {
  Controller robot({{20, 1}});
  CHECK(*robot.program("2 1 2 #", 0) == "2 0 6%20joints%20are%20needed,%202%20were%20given#");
  CHECK(*robot.program("2 0 200 0 0 0 0 #", 0) == "2 0 J2%20200.0%20is%20not%20in%20-110.0..110.0#");
  CHECK(*robot.program(std::string(80, '1'), 0) == "0 0 no%20end%20of%20the%20request%20within%2080%20characters#");
  CHECK(*robot.program("20 1 #", 0) == "20 0 injected%20failure#");
  CHECK(*robot.program("77 #", 0) == "77 0 unknown%20request#");
  CHECK(robot.service("77 #", 0) == "77 0 unknown%20request#");
}

TEST_CASE("a stop ends the move, and holds until it is lifted") {
  Controller robot;
  robot.program("2 60 0 0 0 30 0 #", 0);
  CHECK(robot.service("91 #", 0.5) == "91 1#");
  CHECK(*robot.advance(0.5) == "2 0 stopped#");
  CHECK(*robot.program("2 60 0 0 0 30 0 #", 1) == "2 0 stopped#");
  CHECK(robot.service("92 #", 2) == "92 1#");
  CHECK_FALSE(robot.program("2 60 0 0 0 30 0 #", 2));
}

TEST_CASE("a motion error: the move's answer, the motors, the service task's state") {
  Controller robot;
  robot.program("2 60 0 0 0 30 0 #", 0);
  CHECK(*robot.raise_fault("grab", "CRITICAL", "arm \"1\" hit", 0.5) == "2 0 arm%20%221%22%20hit#");
  CHECK(robot.service("90 #", 1) == "90 1 0 0 0 50204 grab%20CRITICAL%20arm%20%221%22%20hit#");
  CHECK(*robot.program("2 0 0 0 0 0 0 #", 1) == "2 0 motors%20off#");
  robot.clear();
  CHECK_FALSE(robot.program("2 0 0 0 0 0 0 #", 2));
  CHECK_FALSE(robot.raise_fault("reach", "WARNING", "warm", 2.1));
  CHECK(robot.blocked());
}

TEST_CASE("texts: escaped on the way, shown as they are") {
  Controller robot;
  CHECK(*robot.program("40 say%20%22hi%22%0Anow #", 0) == "40 1#");
  CHECK(robot.take_events().back() == "text say \"hi\"\\nnow");
  CHECK(unescape(escape("a #%\"\n\xc3")) == "a #%\"\n\xc3");
}
