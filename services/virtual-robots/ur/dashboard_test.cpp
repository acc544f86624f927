#include "services/virtual-robots/ur/dashboard.hpp"

#include <doctest/doctest.h>

using namespace trb::virtual_robots::ur;

TEST_CASE("dashboard: what runs, in which mode, and a line that it does not know") {
  Controller controller(RobotMode::PowerOff);
  const auto ask = [&](std::string_view line) { return dashboard_answer(line, controller, 0); };
  CHECK(ask("running") == "Program running: false");
  CHECK(ask("programState") == "STOPPED <unnamed>");
  CHECK(ask("robotmode") == "Robotmode: POWER_OFF");
  CHECK(ask("power on") == "Powering on");
  CHECK(ask("robotmode") == "Robotmode: IDLE");
  CHECK(ask("brake release") == "Brake releasing");
  CHECK(ask("robotmode") == "Robotmode: RUNNING");
  controller.take("def pick():\n  sleep(1)\nend", 0);
  CHECK(ask("running") == "Program running: true");
  CHECK(ask("programState") == "PLAYING pick");
  CHECK(ask("stop") == "Stopped");
  CHECK(ask("running") == "Program running: false");
  CHECK(ask("make coffee\x01") == "could not understand: 'make coffee\\x01'");
}

TEST_CASE("dashboard: a protective stop is told and lifted") {
  Controller controller;
  const auto ask = [&](std::string_view line) { return dashboard_answer(line, controller, 0); };
  controller.set_safety(SafetyMode::ProtectiveStop, 0);
  CHECK(ask("safetymode") == "Safetymode: PROTECTIVE_STOP");
  CHECK(ask("unlock protective stop") == "Protective stop releasing");
  CHECK(ask("safetymode") == "Safetymode: NORMAL");
}
