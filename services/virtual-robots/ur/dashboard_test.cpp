#include "services/virtual-robots/ur/dashboard_words.hpp"

#include <doctest/doctest.h>

using namespace trb::virtual_robots::ur;

namespace {

std::optional<std::string> shelf(std::string_view name) {
  if (name == "pick.urp") return "def pick():\n  sleep(10)\nend\n";
  if (name == "bad.urp") return "def bad():\n  dance()\nend\n";
  return std::nullopt;
}

struct DashboardBench {
  std::string ask(std::string_view line) { return words.answer(line, controller, now); }
  Controller controller;
  DashboardWords words{shelf};
  double now = 0;
};

}  // namespace

TEST_CASE("dashboard: what runs, in which mode, and a line that it does not know") {
  DashboardBench bench;
  bench.controller = Controller(RobotMode::PowerOff);
  CHECK(bench.ask("running") == "Program running: false");
  CHECK(bench.ask("programState") == "STOPPED <unnamed>");
  CHECK(bench.ask("robotmode") == "Robotmode: POWER_OFF");
  CHECK(bench.ask("power on") == "Powering on");
  CHECK(bench.ask("robotmode") == "Robotmode: IDLE");
  CHECK(bench.ask("power off") == "Powering off");
  CHECK(bench.ask("brake release") == "Brake releasing");  // it switches the power on by itself
  CHECK(bench.ask("robotmode") == "Robotmode: RUNNING");
  bench.controller.take("def pick():\n  sleep(1)\nend", 0);
  CHECK(bench.ask("running") == "Program running: true");
  CHECK(bench.ask("programState") == "PLAYING pick");
  CHECK(bench.ask("stop") == "Stopped");
  CHECK(bench.ask("stop") == "Failed to execute: stop");
  CHECK(bench.ask("running") == "Program running: false");
  CHECK(bench.ask("make coffee\x01") == "could not understand: 'make coffee\\x01'");
}

TEST_CASE("dashboard: what a client asks first, and what is always answered the same") {
  DashboardBench bench;
  CHECK(bench.ask("PolyscopeVersion") == "URSoftware 5.12.0.0 (Jan 01 2022)");
  CHECK(bench.ask("safetystatus") == "Safetystatus: NORMAL");
  CHECK(bench.ask("close safety popup") == "closing safety popup");
  CHECK(bench.ask("popup look there") == "showing popup");
  CHECK(bench.ask("close popup") == "closing popup");
  CHECK(bench.ask("is in remote control") == "true");
  CHECK(bench.ask("get robot model") == "UR3");
  CHECK(bench.ask("get serial number") == "20175399999");
  CHECK(bench.ask("addToLog at the belt") == "Added log message");
  CHECK(bench.ask("addToLog") == "No log message to add");
}

TEST_CASE("dashboard: a protective stop is lifted after 5 s, not before") {
  DashboardBench bench;
  CHECK(bench.ask("unlock protective stop") == "Protective stop releasing");
  bench.controller.set_safety(SafetyMode::ProtectiveStop, 0);
  CHECK(bench.ask("safetymode") == "Safetymode: PROTECTIVE_STOP");
  CHECK(bench.ask("safetystatus") == "Safetystatus: PROTECTIVE_STOP");
  bench.now = 4.9;
  CHECK(bench.ask("unlock protective stop").starts_with("Cannot unlock protective stop until 5s after occurrence. "));
  CHECK(bench.ask("safetymode") == "Safetymode: PROTECTIVE_STOP");
  bench.now = 5;
  CHECK(bench.ask("unlock protective stop") == "Protective stop releasing");
  CHECK(bench.ask("safetymode") == "Safetymode: NORMAL");
}

TEST_CASE("dashboard: an emergency stop takes the power, and refuses it until it is released") {
  DashboardBench bench;
  bench.controller.set_safety(SafetyMode::EmergencyStop, 0);
  CHECK(bench.ask("safetystatus") == "Safetystatus: ROBOT_EMERGENCY_STOP");
  CHECK(bench.ask("power on") == "Failed to execute: power on");
  CHECK(bench.ask("brake release") == "Failed to execute: brake release");
  CHECK(bench.ask("robotmode") == "Robotmode: POWER_OFF");
  bench.controller.set_safety(SafetyMode::Normal, 0);
  CHECK(bench.ask("brake release") == "Brake releasing");
  CHECK(bench.ask("robotmode") == "Robotmode: RUNNING");
}

TEST_CASE("dashboard: programs are loaded, played, paused and played again") {
  DashboardBench bench;
  CHECK(bench.ask("get loaded program") == "No program loaded");
  CHECK(bench.ask("play") == "Failed to execute: play");
  CHECK(bench.ask("pause") == "Failed to execute: pause");
  for (const char* name : {"none.urp", "../pick.urp", "/etc/passwd", "", ".pick.urp"}) {
    CHECK(bench.ask("load " + std::string(name)) == "File not found: " + std::string(name));
  }
  CHECK(bench.ask("load bad.urp") == "Error while loading program: bad.urp");
  CHECK(bench.ask("load /programs/pick.urp") == "Loading program: /programs/pick.urp");
  CHECK(bench.ask("get loaded program") == "Loaded program: /programs/pick.urp");
  CHECK(bench.ask("programState") == "STOPPED pick.urp");
  CHECK(bench.ask("play") == "Starting program");
  CHECK(bench.ask("programState") == "PLAYING pick.urp");
  CHECK(bench.ask("play") == "Failed to execute: play");
  bench.now = 4;
  CHECK(bench.ask("pause") == "Pausing program");
  CHECK(bench.ask("programState") == "PAUSED pick.urp");
  bench.now = 100;
  CHECK(bench.ask("play") == "Starting program");
  bench.now = 105.5;
  bench.controller.advance(bench.now);
  CHECK(bench.ask("running") == "Program running: true");
  bench.now = 106.5;
  bench.controller.advance(bench.now);
  CHECK(bench.ask("running") == "Program running: false");
  bench.ask("power off");
  CHECK(bench.ask("play") == "Failed to execute: play");
}
