#include "services/virtual-robots/text/dialogue.hpp"

#include <doctest/doctest.h>

using namespace trb::virtual_robots::text;

namespace {

/** Takes the requests of the bytes, and puts their answers together. */
std::string say(Dialogue& robot, std::string bytes, double now = 0, std::uint64_t client = 1) {
  std::string out;
  while (const auto request = robot.take(bytes)) out += robot.answer(client, *request, now) + std::string(robot.end());
  return out;
}

}  // namespace

TEST_CASE("a Dobot enables, moves, stops and tells its angles and its mode") {
  const auto robot = make_dobot();
  CHECK(say(*robot, "RobotMode()") == "0,{4},RobotMode();");
  CHECK(say(*robot, "MovJ(joint={1,2,3,4,5,6})") == "-1,{},MovJ(joint={1,2,3,4,5,6});");
  CHECK(say(*robot, "enablerobot()RobotMode()") == "0,{},enablerobot();0,{5},RobotMode();");
  CHECK(say(*robot, "MovJ(joint={1,2,3,4,5,6})") == "0,{1},MovJ(joint={1,2,3,4,5,6});");
  CHECK(say(*robot, "RobotMode()") == "0,{7},RobotMode();");
  CHECK(say(*robot, "RobotMode()GetAngle()", 100) ==
        "0,{5},RobotMode();0,{1.000000,2.000000,3.000000,4.000000,5.000000,6.000000},GetAngle();");
  say(*robot, "MovJ(joint={90,0,0,0,0,0})", 100);
  CHECK(say(*robot, "Stop()RobotMode()", 100.1) == "0,{},Stop();0,{5},RobotMode();");
}

TEST_CASE("a Dobot refuses what it does not know, and everything in an alarm but a stop") {
  const auto robot = make_dobot();
  say(*robot, "EnableRobot()");
  CHECK(say(*robot, "JointMovJ(1)") == "-10000,{},JointMovJ(1);");
  CHECK(say(*robot, "MovJ(joint={1,2})") == "-20000,{},MovJ(joint={1,2});");
  CHECK(say(*robot, "MovJ(1,2,3,4,5,6)") == "-30001,{},MovJ(1,2,3,4,5,6);");
  CHECK(say(*robot, ")") == "-10000,{},);");
  robot->fail(1);
  CHECK(say(*robot, "RobotMode()MovJ(joint={1,2,3,4,5,6})Stop()", 1) ==
        "0,{9},RobotMode();-2,{},MovJ(joint={1,2,3,4,5,6});0,{},Stop();");
  CHECK(say(*robot, "ClearError()RobotMode()", 1) == "0,{},ClearError();0,{5},RobotMode();");
}

TEST_CASE("the controller with a login knows each client by its password") {
  const auto robot = make_login("secret");
  CHECK(say(*robot, "$GetStatus\r\n") == "!GetStatus,11\r\n");
  CHECK(say(*robot, "$Login,wrong\r\n") == "!Login,13\r\n");
  CHECK(say(*robot, "Login\r\n") == "!Login,10\r\n");
  CHECK(say(*robot, "$Login,secret\r\n$GetStatus\r\n") == "#Login,0\r\n#GetStatus,0100000001,0000\r\n");
  CHECK(say(*robot, "$Start,0\r\n$GetStatus\r\n$Start,0\r\n") ==
        "#Start,0\r\n#GetStatus,0100000010,0000\r\n!Start,20\r\n");
  CHECK(say(*robot, "$Stop\r\n", 0, 2) == "!Stop,11\r\n");
  CHECK(say(*robot, "$Stop\r\n$GetStatus\r\n") == "#Stop,0\r\n#GetStatus,0100000001,0000\r\n");
  robot->fail(1);
  CHECK(say(*robot, "$GetStatus\r\n$Start,0\r\n$Reset\r\n") ==
        "#GetStatus,0100001000,9000\r\n!Start,20\r\n#Reset,0\r\n");
}

TEST_CASE("a vehicle tells its arrival, and stops if it hears nothing for its time") {
  const auto robot = make_alive(1);
  CHECK(say(*robot, "GOTO 0.2 0\nPOSE\n") == "OK\nPOSE 0.000 0.000\n");
  CHECK(*robot->next_deadline() == doctest::Approx(0.4));
  CHECK(robot->advance(0.4) == std::vector<std::string>{"ARRIVED 0.200 0.000"});
  CHECK_FALSE(robot->next_deadline());
  say(*robot, "GOTO 10 0\n", 1);
  CHECK(robot->advance(1.9).empty());
  say(*robot, "PING\n", 1.9);
  CHECK(robot->advance(2.8).empty());
  CHECK(robot->advance(2.9) == std::vector<std::string>{"LOST silence"});
  CHECK(say(*robot, "STATE\nGOTO 1 1\nRESUME\nGOTO 1 x\n", 3) == "STATE silent\nERROR silence\nOK\nERROR numbers\n");
  say(*robot, "GOTO 9 9\nSTOP\n", 3);
  CHECK(robot->advance(3) == std::vector<std::string>{"LOST stopped"});
}
