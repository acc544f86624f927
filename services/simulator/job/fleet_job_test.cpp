#include "services/simulator/job/fleet_job.hpp"

#include <doctest/doctest.h>

#include <algorithm>

#include "services/simulator/job/job.hpp"

using namespace trb;
using namespace trb::simulator;

namespace {

/// Two carts that drive to places, and an arm that grips.
const std::string kFleet = R"([
  {"id": "cart1", "profile": {"capabilities": ["drive"], "places": ["dock", "table"], "skills":
    [{"name": "go_to", "capability": "drive", "parameters": [{"name": "place", "type": "place", "required": true}],
      "repeatable": true, "timeout_s": 60}]}},
  {"id": "cart2", "profile": {"capabilities": ["drive"], "places": ["dock", "table"], "skills":
    [{"name": "go_to", "capability": "drive", "parameters": [{"name": "place", "type": "place", "required": true}],
      "repeatable": true, "timeout_s": 60}]}},
  {"id": "arm", "profile": {"capabilities": ["grip"], "skills": [{"name": "pick", "capability": "grip", "timeout_s": 60}]}}
])";
const std::string kScenario = R"({"name": "two carts", "tasks": [
  {"id": "to_table", "requires": ["drive"], "skill": "go_to", "data": {"place": "table"}},
  {"id": "to_dock", "robot": "cart2", "skill": "go_to", "data": {"place": "dock"}},
  {"id": "pick", "robot": "arm", "skill": "pick", "after": ["to_table"]}]})";

std::string job_of(const std::string& fleet, const std::string& scenario, const std::string& more = "") {
  return R"({"protocol": "talkrobots", "fleet": )" + fleet + R"(, "scenario": )" + scenario + more + "}";
}

}  // namespace

TEST_CASE("a hall's own robots play its own scenario, each skill in its own time") {
  ConfigFaults faults;
  const Job job = read_job(job_of(kFleet, kScenario, R"(, "times": {"go_to": 5, "pick": {"mean": 2}})"), faults);
  REQUIRE_MESSAGE(faults.empty(), to_text(faults));
  world::World world(*job.world);
  const world::Played played = world.play();
  CHECK(played.broken.empty());
  CHECK(played.over_everywhere);
  CHECK(played.state == RunState::finished);
  CHECK(played.tasks_done == 3);
  // Five and two seconds, and what the cloud takes to choose a cart.
  CHECK(played.makespan_s > 7);
  CHECK(played.makespan_s < 10);
}

TEST_CASE("one task may have a time of its own") {
  ConfigFaults faults;
  const Job job =
      read_job(job_of(kFleet, kScenario, R"(, "times": {"go_to": 5, "pick": 2, "task:to_table": 8})"), faults);
  REQUIRE_MESSAGE(faults.empty(), to_text(faults));
  const double makespan_s = world::World(*job.world).play().makespan_s;
  CHECK(makespan_s > 10);
  CHECK(makespan_s < 13);
}

TEST_CASE("a task takes a value that the job says its robot tells") {
  const std::string scenario = R"({"name": "where to", "tasks": [
      {"id": "look", "robot": "arm", "skill": "pick"},
      {"id": "go", "robot": "cart1", "skill": "go_to", "after": ["look"], "data": {"place": {"from": "look", "value": "at"}}}]})";
  ConfigFaults faults;
  const Job job =
      read_job(job_of(kFleet, scenario, R"(, "times": {"task:look": {"mean": 2, "result": {"at": "dock"}}})"), faults);
  REQUIRE_MESSAGE(faults.empty(), to_text(faults));
  world::World world(*job.world);
  CHECK(world.play().state == RunState::finished);
  CHECK(world.witness().done("go") == 1);
  read_job(job_of(kFleet, scenario), faults);
  REQUIRE(faults.size() == 1);
  CHECK(faults[0].key == "times.task:look.result");
}

TEST_CASE("a robot that breaks is replaced by one that can do the same, if the task names none") {
  ConfigFaults faults;
  const std::string scenario = R"({"name": "one", "tasks": [
      {"id": "to_table", "robot": "cart1", "skill": "go_to", "data": {"place": "table"}}]})";
  const std::string break_it = R"(, "faults": [{"at": 1, "kind": "fail", "node": "cart1"}])";
  const Job job = read_job(job_of(kFleet, scenario, break_it), faults);
  REQUIRE_MESSAGE(faults.empty(), to_text(faults));
  world::World world(*job.world);
  const world::Played played = world.play();
  CHECK(played.broken.empty());
  CHECK(played.state == RunState::finished);
  CHECK(world.witness().done("to_table") == 1);
}

TEST_CASE("what is wrong with a fleet, its scenario or its times is named") {
  struct Case {
    std::string text;
    std::string key;
  };
  const std::string twice = R"([{"id": "a", "profile": {}}, {"id": "a", "profile": {}}])";
  for (const Case& one :
       {Case{job_of("[]", kScenario), "fleet"}, Case{job_of(twice, kScenario), "fleet[1].id"},
        Case{job_of(R"([{"id": "cloud", "profile": {}}])", kScenario), "fleet[0].id"},
        Case{job_of(R"([{"id": "a b", "profile": {}}])", kScenario), "fleet[0].id"},
        Case{job_of(R"([{"id": "a", "profile": {"skills": 3}}])", kScenario), "fleet[0].profile"},
        Case{job_of(R"([{"id": "a"}])", kScenario), "fleet[0].profile"},
        Case{job_of(kFleet, R"({"name": "x"})"), "tasks"},
        Case{job_of(kFleet, R"({"name": "x", "tasks": [{"id": "t", "robot": "arm", "skill": "fly"}]})"),
             "tasks[0].skill"},
        Case{job_of(kFleet, kScenario, R"(, "times": {"pick": -1})"), "times.pick"},
        Case{job_of(kFleet, kScenario, R"(, "times": {"pick": {"mean": 1, "deviation": 2}})"), "times.pick.deviation"},
        Case{job_of(kFleet, kScenario, R"(, "times": {"fly": 1})"), "times.fly"},
        Case{job_of(kFleet, kScenario, R"(, "times": {"task:nobody": 1})"), "times.task:nobody"},
        Case{job_of(kFleet, kScenario, R"(, "robots": 3)"), "robots"},
        Case{job_of(kFleet, kScenario, R"(, "faults": [{"at": 1, "kind": "kill", "node": "r0"}])"),
             "faults[0].node"}}) {
    CAPTURE(one.text);
    ConfigFaults faults;
    static_cast<void>(read_job(one.text, faults));
    REQUIRE_FALSE(faults.empty());
    CHECK_MESSAGE(std::ranges::any_of(faults, [&](const ConfigFault& fault) { return fault.key == one.key; }),
                  to_text(faults));
  }
}

TEST_CASE("a fleet of a thousand robots whose job has some megabytes is taken, and one over 4 MiB refused") {
  std::string fleet;
  for (int robot = 0; robot < 1000; ++robot) {
    std::string skills;
    for (int skill = 0; skill < 20; ++skill) {
      skills += std::string(skill == 0 ? "" : ",") + R"({"name": "skill)" + std::to_string(skill) +
                R"(", "capability": "drive", "repeatable": true, "timeout_s": 60, "parameters": []})";
    }
    fleet += std::string(robot == 0 ? "" : ",") + R"({"id": "cart)" + std::to_string(robot) +
             R"(", "profile": {"capabilities": ["drive"], "skills": [)" + skills + "]}}";
  }
  const std::string scenario = R"({"name": "one", "tasks": [{"id": "go", "robot": "cart999", "skill": "skill1"}]})";
  const std::string text = job_of("[" + fleet + "]", scenario);
  REQUIRE(text.size() > (1U << 20U));
  REQUIRE(text.size() < kMaxJob);
  ConfigFaults faults;
  const Job job = read_job(text, faults);
  REQUIRE_MESSAGE(faults.empty(), to_text(faults));
  CHECK(job.world->fleet.size() == 1000);
  static_cast<void>(read_job(text + std::string(kMaxJob, ' '), faults));
  CHECK(faults.size() == 1);
}
