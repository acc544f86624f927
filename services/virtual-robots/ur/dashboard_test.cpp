#include "services/virtual-robots/ur/dashboard_answers.hpp"

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

struct DashboardFixture {
  std::string ask(std::string_view line) { return words.answer(line, controller, now); }
  /** Each line is answered by the one beside it. */
  void talk(std::initializer_list<std::pair<const char*, const char*>> lines) {
    for (const auto& exchange : lines) {
      CAPTURE(exchange.first);
      CHECK(ask(exchange.first) == exchange.second);
    }
  }
  Controller controller;
  DashboardAnswers words{shelf};
  double now = 0;
};

}  // namespace

TEST_CASE("dashboard: what runs, in which mode, and a line that it does not know") {
  DashboardFixture fixture;
  fixture.controller = Controller(RobotMode::power_off);
  fixture.talk({
      {"running", "Program running: false"},
      {"programState", "STOPPED <unnamed>"},
      {"robotmode", "Robotmode: POWER_OFF"},
      {"power on", "Powering on"},
      {"robotmode", "Robotmode: IDLE"},
      {"power off", "Powering off"},
      {"brake release", "Brake releasing"},  // it switches the power on by itself
      {"robotmode", "Robotmode: RUNNING"},
  });
  fixture.controller.take("def pick():\n  sleep(1)\nend", 0);
  fixture.talk({
      {"running", "Program running: true"},
      {"programState", "PLAYING pick"},
      {"stop", "Stopped"},
      {"stop", "Failed to execute: stop"},
      {"running", "Program running: false"},
      {"make coffee\x01", "could not understand: 'make coffee\\x01'"},
  });
}

TEST_CASE("dashboard: what a client asks first, and what is always answered the same") {
  DashboardFixture fixture;
  fixture.talk({
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
  DashboardFixture fixture;
  CHECK(fixture.ask("unlock protective stop") == "Protective stop releasing");
  fixture.controller.set_safety(SafetyMode::protective_stop, 0);
  CHECK(fixture.ask("safetymode") == "Safetymode: PROTECTIVE_STOP");
  CHECK(fixture.ask("safetystatus") == "Safetystatus: PROTECTIVE_STOP");
  fixture.now = 4.9;
  CHECK(fixture.ask("unlock protective stop").starts_with("Cannot unlock protective stop until 5s after occurrence. "));
  CHECK(fixture.ask("safetymode") == "Safetymode: PROTECTIVE_STOP");
  fixture.now = 5;
  CHECK(fixture.ask("unlock protective stop") == "Protective stop releasing");
  CHECK(fixture.ask("safetymode") == "Safetymode: NORMAL");
}

TEST_CASE("dashboard: an emergency stop takes the power, and refuses it until it is released") {
  DashboardFixture fixture;
  fixture.controller.set_safety(SafetyMode::emergency_stop, 0);
  fixture.talk({
      {"safetystatus", "Safetystatus: ROBOT_EMERGENCY_STOP"},
      {"power on", "Failed to execute: power on"},
      {"brake release", "Failed to execute: brake release"},
      {"robotmode", "Robotmode: POWER_OFF"},
  });
  fixture.controller.set_safety(SafetyMode::normal, 0);
  CHECK(fixture.ask("brake release") == "Brake releasing");
  CHECK(fixture.ask("robotmode") == "Robotmode: RUNNING");
}

TEST_CASE("dashboard: programs are loaded, played, paused and played again") {
  DashboardFixture fixture;
  fixture.talk({
      {"get loaded program", "No program loaded"},
      {"play", "Failed to execute: play"},
      {"pause", "Failed to execute: pause"},
  });
  for (const char* name : {"none.urp", "../pick.urp", "/etc/passwd", "", ".pick.urp"}) {
    CHECK(fixture.ask("load " + std::string(name)) == "File not found: " + std::string(name));
  }
  fixture.talk({
      {"load bad.urp", "Error while loading program: bad.urp"},
      {"load /programs/pick.urp", "Loading program: /programs/pick.urp"},
      {"get loaded program", "Loaded program: /programs/pick.urp"},
      {"programState", "STOPPED pick.urp"},
      {"play", "Starting program"},
      {"programState", "PLAYING pick.urp"},
      {"play", "Failed to execute: play"},
  });
  fixture.now = 4;
  CHECK(fixture.ask("pause") == "Pausing program");
  CHECK(fixture.ask("programState") == "PAUSED pick.urp");
  fixture.now = 100;
  CHECK(fixture.ask("play") == "Starting program");
  fixture.now = 105.5;
  fixture.controller.advance(fixture.now);
  CHECK(fixture.ask("running") == "Program running: true");
  fixture.now = 106.5;
  fixture.controller.advance(fixture.now);
  CHECK(fixture.ask("running") == "Program running: false");
  fixture.ask("power off");
  CHECK(fixture.ask("play") == "Failed to execute: play");
}
