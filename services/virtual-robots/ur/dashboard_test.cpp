#include "services/virtual-robots/ur/dashboard_words.hpp"

#include <doctest/doctest.h>

#include <initializer_list>
#include <utility>

using namespace trb::virtual_robots::ur;

namespace {

std::optional<std::string> shelf(std::string_view name) {
  if (name == "pick.urp") return "def pick():\n  sleep(10)\nend\n";
  if (name == "bad.urp") return "def bad():\n  dance()\nend\n";
  return std::nullopt;
}

struct DashboardBench {
  std::string ask(std::string_view line) { return words.answer(line, controller, now); }
  /** Each line is answered by the one beside it. */
  void talk(std::initializer_list<std::pair<const char*, const char*>> lines) {
    for (const auto& [line, answer] : lines) {
      CAPTURE(line);
      CHECK(ask(line) == answer);
    }
  }
  Controller controller;
  DashboardWords words{shelf};
  double now = 0;
};

}  // namespace

TEST_CASE("dashboard: what runs, in which mode, and a line that it does not know") {
  DashboardBench bench;
  bench.controller = Controller(RobotMode::PowerOff);
  bench.talk({
      {"running", "Program running: false"},
      {"programState", "STOPPED <unnamed>"},
      {"robotmode", "Robotmode: POWER_OFF"},
      {"power on", "Powering on"},
      {"robotmode", "Robotmode: IDLE"},
      {"power off", "Powering off"},
      {"brake release", "Brake releasing"},  // it switches the power on by itself
      {"robotmode", "Robotmode: RUNNING"},
  });
  bench.controller.take("def pick():\n  sleep(1)\nend", 0);
  bench.talk({
      {"running", "Program running: true"},
      {"programState", "PLAYING pick"},
      {"stop", "Stopped"},
      {"stop", "Failed to execute: stop"},
      {"running", "Program running: false"},
      {"make coffee\x01", "could not understand: 'make coffee\\x01'"},
  });
}

TEST_CASE("dashboard: what a client asks first, and what is always answered the same") {
  DashboardBench bench;
  bench.talk({
      {"PolyscopeVersion", "URSoftware 5.12.0.0 (Jan 01 2022)"},
      {"safetystatus", "Safetystatus: NORMAL"},
      {"close safety popup", "closing safety popup"},
      {"popup look there", "showing popup"},
      {"close popup", "closing popup"},
      {"is in remote control", "true"},
      {"get robot model", "UR3"},
      {"get serial number", "20175399999"},
      {"addToLog at the belt", "Added log message"},
      {"addToLog", "No log message to add"},
  });
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
  bench.talk({
      {"safetystatus", "Safetystatus: ROBOT_EMERGENCY_STOP"},
      {"power on", "Failed to execute: power on"},
      {"brake release", "Failed to execute: brake release"},
      {"robotmode", "Robotmode: POWER_OFF"},
  });
  bench.controller.set_safety(SafetyMode::Normal, 0);
  CHECK(bench.ask("brake release") == "Brake releasing");
  CHECK(bench.ask("robotmode") == "Robotmode: RUNNING");
}

TEST_CASE("dashboard: programs are loaded, played, paused and played again") {
  DashboardBench bench;
  bench.talk({
      {"get loaded program", "No program loaded"},
      {"play", "Failed to execute: play"},
      {"pause", "Failed to execute: pause"},
  });
  for (const char* name : {"none.urp", "../pick.urp", "/etc/passwd", "", ".pick.urp"}) {
    CHECK(bench.ask("load " + std::string(name)) == "File not found: " + std::string(name));
  }
  bench.talk({
      {"load bad.urp", "Error while loading program: bad.urp"},
      {"load /programs/pick.urp", "Loading program: /programs/pick.urp"},
      {"get loaded program", "Loaded program: /programs/pick.urp"},
      {"programState", "STOPPED pick.urp"},
      {"play", "Starting program"},
      {"programState", "PLAYING pick.urp"},
      {"play", "Failed to execute: play"},
  });
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
