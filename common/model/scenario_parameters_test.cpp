#include "common/model/scenario_parameters.hpp"

#include <doctest/doctest.h>

using namespace trb;
using namespace trb::model;

namespace {

/// Tasks one after the other, a letter a robot; '?' names none.
Scenario scenario_of(const std::string& robots) {
  Scenario out{.name = "letters", .tasks = {}};
  for (std::size_t i = 0; i < robots.size(); ++i) {
    Task task;
    task.id = "t" + std::to_string(i);
    if (robots[i] == '?') {
      task.requires_ = {"carry"};
    } else {
      task.robot = std::string(1, robots[i]);
    }
    task.skill = "work";
    if (i > 0) task.after = {static_cast<std::uint16_t>(i - 1)};
    out.tasks.push_back(task);
  }
  return out;
}

}  // namespace

TEST_CASE("Figure 9: twelve tasks in three blocks of seven make seven forwards") {
  const ScenarioParameters found = parameters_of(scenario_of("aabcccdbaadc"), {});
  CHECK(found.paper == PaperParameters{.n = 4, .N_d = 12, .k = 3, .sum_m = 7});
  CHECK(found.assumed.empty());
  CHECK(check(found.paper).ok());
  CHECK(forward(found.paper) == 7);
}

TEST_CASE("tasks of robots in the interpreter mode are counted apart") {
  const ScenarioParameters found = parameters_of(scenario_of("abab"), {"b"});
  CHECK(found.paper == PaperParameters{.n = 2, .N_d = 2, .N_i = 2});
}

TEST_CASE("one robot alone has one block of all its tasks") {
  CHECK(forward(parameters_of(scenario_of("aaa"), {}).paper) == 0);
  const ScenarioParameters one = parameters_of(scenario_of("a"), {});
  CHECK(one.paper == PaperParameters{.n = 1, .N_d = 1});
  CHECK(check(one.paper).ok());
}

TEST_CASE("a task without a robot counts as another one's, and that is said") {
  const ScenarioParameters found = parameters_of(scenario_of("a??a"), {});
  CHECK(found.paper.n == 3);
  CHECK(forward(found.paper) == 3);
  REQUIRE(found.assumed.size() == 1);
  CHECK(found.assumed[0] == "2 tasks name no robot: each counts as another robot's, told directly");
}

TEST_CASE("a condition is a request of the robot that evaluates it: local if the sensor is its own") {
  Scenario scenario = scenario_of("abb");
  scenario.tasks[1].when = {Condition{.sensor = "temperature", .of = "a"}};  // evaluated by a, which has just finished
  scenario.tasks[2].when = {Condition{.sensor = "temperature", .of = "a"}};  // by b
  const ScenarioParameters found = parameters_of(scenario, {});
  CHECK(found.paper.R_l == 1);
  CHECK(found.paper.R_e == 1);
  CHECK(found.paper.s == 1);
  CHECK(found.assumed.empty());
  scenario.tasks[2].when = {Condition{.sensor = "temperature"}};
  const ScenarioParameters anywhere = parameters_of(scenario, {});
  CHECK(anywhere.paper.R_e == 1);
  CHECK(anywhere.paper.s == 2);
  REQUIRE(anywhere.assumed.size() == 1);
  CHECK(anywhere.assumed[0] == "1 condition names no node of its sensor: each counts as a remote request");
}

TEST_CASE("a fleet has at least the robots that the scenario names") {
  Scenario scenario;
  for (const char* robot : {"a", "b", "", "a"}) {
    Task task;
    task.robot = robot;
    scenario.tasks.push_back(task);
  }
  CHECK(check_named(scenario, 2).ok());
  const Status few = check_named(scenario, 1);
  REQUIRE_FALSE(few.ok());
  CHECK(few.error().what.find("--robots") != std::string::npos);
  CHECK(few.error().hint.find('2') != std::string::npos);
}
