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

const char* const kTwo = R"({"name": "two", "tasks": [
  {"id": "go", "robot": "cart", "skill": "go_to"},
  {"id": "take", "robot": "arm", "skill": "pick", "after": ["go"]}]})";

std::vector<PlayedTask> played(const std::string& answer) {
  return played_tasks(*parse_json(answer), scenario_of(kTwo));
}

}  // namespace

TEST_CASE("the attempts that were done count from the first one's begin") {
  const auto tasks = played(R"({"tasks": [
    {"id": "take", "robot": "arm", "begin_s": 6, "end_s": 8},
    {"id": "go", "robot": "old", "begin_s": 1},
    {"id": "go", "robot": "cart", "begin_s": 2, "end_s": 5.5}]})");
  REQUIRE(tasks.size() == 2);
  CHECK(tasks[0].id == "go");
  CHECK(tasks[0].robot == "cart");
  CHECK(tasks[0].begin_s == 0);
  CHECK(tasks[0].end_s == 3.5);
  CHECK(tasks[1].begin_s == 4);
  CHECK(tasks[1].after == std::vector<std::string>{"go"});
}

TEST_CASE("what each waited for, as JSON") {
  const auto tasks = played(R"({"tasks": [{"id": "go", "robot": "cart", "begin_s": 0, "end_s": 3},
                                          {"id": "take", "robot": "arm", "begin_s": 3.1, "end_s": 5}]})");
  CHECK(dump_json(waits_value(tasks)) == R"([{"task":"go","waited_for":"","robot_busy":false,"critical":true},)"
                                         R"({"task":"take","waited_for":"go","robot_busy":false,"critical":true}])");
}

TEST_CASE("what is no attempt of the scenario's is left out") {
  for (const char* text : {R"({})", R"([])", R"({"tasks": 7})", R"({"tasks": [7, {}, {"id": 1}]})",
                           R"({"tasks": [{"id": "x", "robot": "cart", "begin_s": 0, "end_s": 1}]})",
                           R"({"tasks": [{"id": "go", "robot": "cart", "begin_s": "0", "end_s": 1}]})"}) {
    CAPTURE(text);
    CHECK(played(text).empty());
  }
}
