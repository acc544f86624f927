#include "common/scenario/definition.hpp"

#include <doctest/doctest.h>

#include <chrono>

using namespace trb;

namespace {

struct Read {
  Scenario scenario;
  ConfigFaults faults;
};

Read read(const std::string& text) {
  const auto json = parse_json(text);
  REQUIRE_MESSAGE(json.ok(), text);
  Read out;
  out.scenario = read_scenario(*json, "s.json", out.faults);
  for (const ConfigFault& fault : out.faults) {
    CHECK(fault.file == "s.json");
    CHECK_FALSE(fault.hint.empty());
  }
  return out;
}

/// A scenario of tasks that differ only in id and predecessors: {{"a", "\"b\""}, …}.
Read read_graph(const std::vector<std::pair<std::string, std::string>>& tasks) {
  std::string text;
  for (const auto& [id, after] : tasks) {
    if (!text.empty()) text += ",";
    text += R"({"id":")" + id + R"(","robot":"r","skill":"go","after":[)" + after + "]}";
  }
  return read(R"({"name":"n","tasks":[)" + text + "]}");
}

std::map<std::string, NodeProfile> fleet() {
  NodeProfile robot;
  robot.places = {"dock", "table1"};
  robot.skills = {{"go_to", "mobile", {{"place", "place", true, ""}, {"speed", "number", false, "m/s"}}, true, 60},
                  {"pose", "grab", {{"joints", "numbers", true, "rad"}, {"count", "integer", false, ""}}, false, 60},
                  {"say", "speak", {{"words", "text", true, ""}, {"loud", "bool", false, ""}}, false, 60}};
  return {{"r1", robot}, {"cloud", {}}};
}

/// The faults that check_scenario reports for one task.
ConfigFaults check(const std::string& robot, const std::string& skill, const std::string& data) {
  Scenario scenario;
  scenario.tasks = {{"t", robot, {}, skill, data, {}, 0, false, {}}};
  ConfigFaults faults;
  check_scenario(scenario, fleet(), "s.json", faults);
  for (const ConfigFault& fault : faults) {
    CHECK(fault.file == "s.json");
    CHECK_FALSE(fault.hint.empty());
  }
  return faults;
}

}  // namespace

TEST_CASE("a scenario: tasks keep their order, data become compact JSON, predecessors indexes") {
  const Read r = read(R"({"name": "n", "description": "d", "tasks": [
    {"id": "b", "robot": "r", "skill": "go", "after": ["a"], "timeout_s": 2.5, "pinned": true},
    {"_comment": "first", "id": "a", "robot": "q", "skill": "goTo", "data": {"to": "x",  "n": [1, 2]}}]})");
  REQUIRE(to_text(r.faults) == "");
  REQUIRE(r.scenario.tasks.size() == 2);
  CHECK(r.scenario.name == "n");
  CHECK(r.scenario.description == "d");
  CHECK(r.scenario.tasks[0] == Task{"b", "r", {}, "go", "", {1}, 2.5, true, {}});
  CHECK(r.scenario.tasks[1] == Task{"a", "q", {}, "goTo", R"({"to":"x","n":[1,2]})", {}, 0, false, {}});
}

TEST_CASE("a cycle is told with the tasks on it, in the order of running") {
  const Read r =
      read_graph({{"start", ""}, {"pick", R"("drop","start")"}, {"carry", R"("pick")"}, {"drop", R"("carry")"}});
  REQUIRE(r.faults.size() == 1);
  CHECK(r.faults[0].key == "tasks[1].after");
  CHECK(r.faults[0].what.ends_with("pick -> carry -> drop -> pick"));
  CHECK(read_graph({{"a", R"("a")"}}).faults.at(0).what.ends_with(": a -> a"));
  CHECK(read_graph({{"a", R"("b")"}, {"b", R"("a")"}, {"c", R"("d")"}, {"d", R"("c")"}}).faults.size() == 2);
}

TEST_CASE("a diamond is no cycle, nor is a chain of a thousand tasks") {
  CHECK(read_graph({{"a", ""}, {"b", R"("a")"}, {"c", R"("a")"}, {"d", R"("b","c")"}}).faults.empty());
  std::vector<std::pair<std::string, std::string>> chain;
  for (int i = 0; i < 1000; ++i) {
    chain.emplace_back("t" + std::to_string(i), i == 999 ? "" : "\"t" + std::to_string(i + 1) + "\"");
  }
  CHECK(read_graph(chain).faults.empty());
  chain.back().second = R"("t0")";
  CHECK(read_graph(chain).faults.size() == 1);
}

TEST_CASE("ids: twice the same, unknown, and named twice") {
  const Read r = read_graph({{"pick", ""}, {"pick", R"("pikc")"}, {"c", R"("pick","pick")"}, {"Bad", ""}});
  REQUIRE(r.faults.size() == 4);
  CHECK(r.faults[0].key == "tasks[2].after[1]");
  CHECK(r.faults[1].key == "tasks[3].id");
  CHECK(r.faults[2].key == "tasks[1].id");
  CHECK(r.faults[2].what.find("tasks[0]") != std::string::npos);
  CHECK(r.faults[3].key == "tasks[1].after");
  CHECK(r.faults[3].hint == "did you mean 'pick'?");
}

TEST_CASE("predecessors that are none of a thousand long ids cost little more than those that are") {
  const auto timed = [](const std::string& ending) {
    const auto id = [](int i) { return "a" + std::string(56, 'x') + std::to_string(1000 + i); };
    std::vector<std::pair<std::string, std::string>> tasks;
    for (int i = 0; i < 1000; ++i) {
      tasks.emplace_back(id(i) + "abc", i == 0 ? "" : '"' + id(i - 1) + ending + '"');
    }
    const auto begun = std::chrono::steady_clock::now();
    ConfigFaults faults = read_graph(tasks).faults;
    return std::pair{std::chrono::steady_clock::now() - begun, std::move(faults)};
  };
  const auto [good, none] = timed("abc");
  CHECK(none.empty());
  // All that differ only late in the word; with one edit to the next, or with more than a guess may have.
  for (const std::string ending : {"abd", "def"}) {
    CAPTURE(ending);
    const auto [bad, faults] = timed(ending);
    REQUIRE(faults.size() == 200);
    CHECK(bad < 10 * good);
    CHECK(faults[0].hint.starts_with("did you mean 'axxx") == (ending == "abd"));
    CHECK(faults[20].hint.starts_with("use ids of this scenario: axxx"));
  }
}

TEST_CASE("a task: types, missing and unknown keys") {
  const std::vector<std::pair<std::string, std::string>> cases = {
      {R"({"robot":"r","skill":"go"})", "tasks[0].id"},
      {R"({"id":"a","skill":"go"})", "tasks[0].robot"},
      {R"({"id":"a","robot":"r"})", "tasks[0].skill"},
      {R"({"id":"a","robot":"r","skill":"go to"})", "tasks[0].skill"},
      {R"({"id":"a","robot":"R 1","skill":"go"})", "tasks[0].robot"},
      {R"({"id":"","robot":"r","skill":"go"})", "tasks[0].id"},
      {R"({"id":"a#2","robot":"r","skill":"go"})", "tasks[0].id"},
      {R"({"id":"a","robot":"","skill":"go"})", "tasks[0].robot"},
      {R"({"id":"a","robot":"r","skill":""})", "tasks[0].skill"},
      {R"({"id":"a","skill":"go","requires":[]})", "tasks[0].requires"},
      {R"({"id":"a","skill":"go","requires":"mobile"})", "tasks[0].requires"},
      {R"({"id":"a","skill":"go","requires":["mobile base"]})", "tasks[0].requires"},
      {R"({"id":"a","skill":"go","requires":["mobile","mobile"]})", "tasks[0].requires[1]"},
      {R"({"id":"a","robot":"r","skill":"go","retries":17})", "tasks[0].retries"},
      {R"({"id":"a","robot":"r","skill":"go","retries":1.5})", "tasks[0].retries"},
      {R"({"id":"a","robot":"r","skill":"go","retry_after_s":0.01})", "tasks[0].retry_after_s"},
      {R"({"id":"a","robot":"r","skill":"go","retry_after_s":3601})", "tasks[0].retry_after_s"},
      {R"({"id":"a","robot":"r","skill":"go","on_failure":"abrot"})", "tasks[0].on_failure"},
      {R"({"id":"a","robot":"r","skill":"go","data":"x"})", "tasks[0].data"},
      {R"({"id":"a","robot":"r","skill":"go","after":"x"})", "tasks[0].after"},
      {R"({"id":"a","robot":"r","skill":"go","timeout_s":-1})", "tasks[0].timeout_s"},
      {R"({"id":"a","robot":"r","skill":"go","timeout_s":"1"})", "tasks[0].timeout_s"},
      {R"({"id":"a","robot":"r","skill":"go","pinned":1})", "tasks[0].pinned"},
      {R"({"id":"a","robot":"r","skil":"go","skill":"go"})", "tasks[0].skil"},
      {R"("a")", "tasks[0]"}};
  for (const auto& [task, key] : cases) {
    CAPTURE(task);
    const Read r = read(R"({"name":"n","tasks":[)" + task + "]}");
    REQUIRE_MESSAGE(r.faults.size() == 1, to_text(r.faults));
    CHECK(r.faults[0].key == key);
  }
}

TEST_CASE("a scenario: its own keys and bounds") {
  CHECK(read("[]").faults.size() == 1);
  CHECK(read("{}").faults.size() == 2);
  CHECK(read(R"({"name":"n","tasks":[]})").faults.at(0).key == "tasks");
  CHECK(read(R"({"name":"n","task":[],"tasks":[]})").faults.at(1).hint == "did you mean 'tasks'?");
  std::string many;
  for (int i = 0; i < 1001; ++i) many += std::string(i == 0 ? "" : ",") + "{}";
  CHECK(read(R"({"name":"n","tasks":[)" + many + "]}").faults.at(0).key == "tasks");
  many.resize(many.size() - 3);
  CHECK(read(R"({"name":"n","tasks":[)" + many + "]}").faults.size() == 200);
}

TEST_CASE("a scenario that the fleet can do") {
  CHECK(check("r1", "go_to", R"({"place":"dock","speed":1})").empty());
  CHECK(check("r1", "pose", R"({"joints":[1,2.5],"count":3})").empty());
  CHECK(check("r1", "say", R"({"words":"hello","loud":true})").empty());
}

TEST_CASE("unknown robots, skills and places, with the word that was meant") {
  struct Case {
    std::string robot, skill, data, key, hint;
  };
  const std::vector<Case> cases = {
      {"r2", "go_to", "", "tasks[0].robot", "did you mean 'r1'?"},
      {"pioneer", "go_to", "", "tasks[0].robot", "start its node, or use one of: r1"},
      {"cloud", "go_to", "", "tasks[0].skill", "use another robot: this node has none, or its robot has no skills"},
      {"r1", "goto", "", "tasks[0].skill", "did you mean 'go_to'?"},
      {"r1", "fly", "", "tasks[0].skill", "use one of: go_to, pose, say"},
      {"r1", "go_to", R"({"place":"tabel1"})", "tasks[0].data.place", "did you mean 'table1'?"},
      {"r1", "go_to", R"({"place":"moon"})", "tasks[0].data.place",
       "add it to places.json of its node, or use one of: dock, table1"}};
  for (const Case& one : cases) {
    CAPTURE(one.hint);
    const ConfigFaults faults = check(one.robot, one.skill, one.data);
    REQUIRE_MESSAGE(faults.size() == 1, to_text(faults));
    CHECK(faults[0].key == one.key);
    CHECK(faults[0].hint == one.hint);
  }
}

TEST_CASE("parameters: missing, unknown and of the wrong type") {
  CHECK(check("r1", "go_to", "").at(0).key == "tasks[0].data.place");
  CHECK(check("r1", "go_to", R"({"place":"dock","sped":1})").at(0).hint == "did you mean 'speed'?");
  CHECK(check("r1", "go_to", R"({"place":1})").at(0).what.find("whole number") != std::string::npos);
  CHECK(check("r1", "go_to", R"({"place":"dock","speed":"1"})").at(0).hint == R"(use "speed": a number in m/s)");
  CHECK(check("r1", "pose", R"({"joints":["1"]})").at(0).key == "tasks[0].data.joints");
  CHECK(check("r1", "pose", R"({"joints":[1],"count":1.5})").at(0).key == "tasks[0].data.count");
  CHECK(check("r1", "say", R"({"words":"a","loud":"yes"})").at(0).key == "tasks[0].data.loud");
  CHECK(check("r1", "say", "[").at(0).key == "tasks[0].data");
}
