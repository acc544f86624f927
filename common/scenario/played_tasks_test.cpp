#include "common/scenario/played_tasks.hpp"

#include <doctest/doctest.h>

using namespace trb;

namespace {

Scenario scenario_of(const std::string& text) {
  ConfigFaults faults;
  Scenario out = read_scenario(*parse_json(text), "scenario", faults);
  REQUIRE(faults_that_stop(faults).empty());
  return out;
}

/// As waits_of says it: "TASK<HOLDER" each, with "!" if the robot was busy.
std::string waits_text(const std::vector<PlayedTask>& tasks) {
  std::string out;
  const auto waits = waits_of(tasks);
  for (std::size_t i = 0; i < tasks.size(); ++i) {
    out += (i == 0 ? "" : " ") + tasks[i].id + "<" + (waits[i].holder ? tasks[*waits[i].holder].id : "");
    if (waits[i].is_robot_busy) out += "!";
  }
  return out;
}

const char* const kTwo = R"({"name": "two", "tasks": [
  {"id": "go", "robot": "cart", "skill": "go_to"},
  {"id": "take", "robot": "arm", "skill": "pick", "after": ["go"]}]})";

std::vector<PlayedTask> played(const std::string& answer) {
  return played_tasks(*parse_json(answer), scenario_of(kTwo));
}

}  // namespace

TEST_CASE("times count from the begin of the first attempt of all, whatever became of it") {
  const auto tasks = played(R"({"tasks": [
    {"id": "take", "robot": "arm", "begin_s": 6, "end_s": 8},
    {"id": "go", "robot": "old", "begin_s": 1},
    {"id": "go", "robot": "cart", "begin_s": 2, "end_s": 5.5}]})");
  REQUIRE(tasks.size() == 3);
  CHECK(tasks[0].robot == "old");
  CHECK(tasks[0].begin_s == 0);
  CHECK(tasks[0].is_open);
  CHECK(tasks[0].is_dropped);
  CHECK(tasks[1].id == "go");
  CHECK(tasks[1].robot == "cart");
  CHECK(tasks[1].begin_s == 1);
  CHECK(tasks[1].end_s == 4.5);
  CHECK_FALSE(tasks[1].is_dropped);
  CHECK(tasks[2].begin_s == 5);
  CHECK(tasks[2].after == std::vector<std::string>{"go"});
}

TEST_CASE("what each waited for, as JSON") {
  const auto tasks = played(R"({"tasks": [{"id": "go", "robot": "cart", "begin_s": 0, "end_s": 3},
                                          {"id": "take", "robot": "arm", "begin_s": 3.1, "end_s": 5}]})");
  CHECK(dump_json(waits_value(tasks)) ==
        R"([{"task":"go","waited_for":"","robot_busy":false,"critical":true,"tried_again":false,"more_s":0.0},)"
        R"({"task":"take","waited_for":"go","robot_busy":false,"critical":true,"tried_again":false,"more_s":0.1}])");
}

TEST_CASE("who comes behind a task that was skipped waited for what that task waited for") {
  const Scenario scenario = scenario_of(R"({"name": "skipped", "tasks": [
    {"id": "c", "robot": "a", "skill": "run"},
    {"id": "a1", "robot": "a", "skill": "run", "after": ["c"]},
    {"id": "a2", "robot": "a", "skill": "run", "after": ["a1"]},
    {"id": "d", "robot": "b", "skill": "run"},
    {"id": "b1", "robot": "b", "skill": "run", "after": ["a2", "d"]}]})");
  const auto tasks = played_tasks(*parse_json(R"({"tasks": [
    {"id": "c", "robot": "a", "begin_s": 0, "end_s": 10},
    {"id": "d", "robot": "b", "begin_s": 0, "end_s": 2},
    {"id": "b1", "robot": "b", "begin_s": 10.1, "end_s": 12}]})"),
                                  scenario);
  CHECK(waits_text(tasks) == "c< d< b1<c");
  CHECK(waits_of(tasks)[0].is_critical);
  CHECK_FALSE(waits_of(tasks)[1].is_critical);
}

TEST_CASE("who comes behind a task that has failed waited until it had failed") {
  const char* const played_to_failure = R"({"tasks": [
    {"id": "go", "robot": "old", "begin_s": 0, "failed_s": 1},
    {"id": "go", "robot": "cart", "begin_s": 2, "failed_s": 7},
    {"id": "take", "robot": "arm", "begin_s": 7.1, "end_s": 9}]})";
  const auto tasks = played(played_to_failure);
  REQUIRE(tasks.size() == 3);
  CHECK(tasks[0].is_dropped);
  CHECK(tasks[1].robot == "cart");
  CHECK(tasks[1].has_failed);
  CHECK(tasks[1].end_s == 7);
  CHECK_FALSE(tasks[1].is_dropped);
  CHECK_FALSE(tasks[2].has_failed);
  CHECK(waits_text(tasks) == "go< go<go take<go");
}

TEST_CASE("of a task that was done in the end a failure is an attempt, too; the JSON has those that count alone") {
  const auto tasks = played(R"({"tasks": [
    {"id": "go", "robot": "old", "begin_s": 10, "failed_s": 18},
    {"id": "go", "robot": "cart", "begin_s": 20, "end_s": 30},
    {"id": "take", "robot": "arm", "begin_s": 30.1, "end_s": 40}]})");
  REQUIRE(tasks.size() == 3);
  CHECK(tasks[0].robot == "old");
  CHECK(tasks[0].end_s == 8);
  CHECK(tasks[2].end_s == 30);  // the makespan
  const Value waits = waits_value(tasks);
  REQUIRE(waits.list().size() == 2);
  CHECK(waits.list()[0].find("waited_for")->text() == "go");
  CHECK(waits.list()[0].find("tried_again")->boolean());
  CHECK(waits.list()[1].find("task")->text() == "take");
  CHECK_FALSE(waits.list()[1].find("tried_again")->boolean());
}

TEST_CASE("what is no attempt of the scenario's is left out") {
  for (const char* text : {R"({})", R"([])", R"({"tasks": 7})", R"({"tasks": [7, {}, {"id": 1}]})",
                           R"({"tasks": [{"id": "go", "robot": "cart", "begin_s": 0, "end_s": "1"}]})",
                           R"({"tasks": [{"id": "x", "robot": "cart", "begin_s": 0, "end_s": 1}]})",
                           R"({"tasks": [{"id": "go", "robot": "cart", "begin_s": "0", "end_s": 1}]})"}) {
    CAPTURE(text);
    CHECK(played(text).empty());
  }
}

TEST_CASE("of two runs at once it is told whose robot the other one kept, and for how long") {
  const Scenario first = scenario_of(kTwo);
  const Scenario second = scenario_of(R"({"name": "one", "tasks": [{"id": "go", "robot": "arm", "skill": "pick"}]})");
  const Value answer = *parse_json(R"({"world": {"submitted_s": 9.9},
    "tasks": [{"id": "go", "robot": "cart", "begin_s": 10, "end_s": 13}, {"id": "take", "robot": "arm", "begin_s": 18, "end_s": 20}],
    "beside": [{"submitted_s": 12, "tasks": [{"id": "go", "robot": "arm", "begin_s": 12.5, "end_s": 18}]}]})");
  const auto tasks = played_tasks(answer, {first, second});
  REQUIRE(tasks.size() == 3);
  CHECK(tasks[1].run == 1);
  CHECK(tasks[1].since_s == 2);
  CHECK(tasks[1].after.empty());
  CHECK(tasks[2].after == std::vector<std::string>{"go"});
  CHECK(dump_json(waits_value(tasks, 0)) ==
        R"([{"task":"go","waited_for":"","robot_busy":false,"critical":false,"tried_again":false,"more_s":0.0},)"
        R"({"task":"take","waited_for":"go","robot_busy":true,"critical":true,"tried_again":false,"more_s":0.0,)"
        R"("waited_for_run":1,"kept_s":5.0}])");
  // The other run's only task is critical for both; it waited for nobody since its own submission.
  CHECK(dump_json(waits_value(tasks, 1)) ==
        R"([{"task":"go","waited_for":"","robot_busy":false,"critical":true,"tried_again":false,"more_s":0.5}])");
}

TEST_CASE("what is no list of runs has no tasks") {
  const Scenario scenario = scenario_of(kTwo);
  for (const char* text : {R"({"beside": 3})", R"({"beside": [7]})", R"({"beside": [{"tasks": {}}]})", "[]"}) {
    CHECK(played_tasks(*parse_json(text), {scenario, scenario}).empty());
  }
}
