#include "services/resilience/core/candidates.hpp"

#include <doctest/doctest.h>

#include <algorithm>

#include "services/resilience/test/fleet_fixture.hpp"

using namespace trb;
using namespace trb::resilience;

namespace {

/// ridgeback moves and loads, pioneer1 and turtlebot move, arm loads.
Fleet hall() {
  Fleet fleet;
  NodeProfile arm = carrier();
  arm.capabilities = {"carry"};
  arm.skills.erase(arm.skills.begin());
  CHECK(fleet.on_route(route_of("turtlebot", mobile_robot()), at_second(0)));
  CHECK(fleet.on_route(route_of("ridgeback", carrier()), at_second(0)));
  CHECK(fleet.on_route(route_of("pioneer1", mobile_robot()), at_second(0)));
  CHECK(fleet.on_route(route_of("arm", arm), at_second(0)));
  return fleet;
}

}  // namespace

TEST_CASE("one robot for all of the tasks, by id, without the faulty one") {
  const Fleet fleet = hall();
  const Candidates found = find_candidates(fleet, {{drive("dock"), drive("table1")}, {"ridgeback"}});
  CHECK(found.robots == Ids{"pioneer1", "turtlebot"});
  CHECK(found.by_task.empty());
  CHECK(found.cover());
  CHECK(found.unsuitable.empty());
  CHECK(found.others == 1);  // the arm has none of the needed words
}

TEST_CASE("several between them, where nobody can do all") {
  const Fleet fleet = hall();
  const Candidates found = find_candidates(fleet, {{drive("dock"), load()}, {"ridgeback"}});
  CHECK(found.robots.empty());
  REQUIRE(found.by_task.size() == 2);
  CHECK(found.by_task[0].task == "drive");
  CHECK(found.by_task[0].robots == Ids{"pioneer1", "turtlebot"});
  CHECK(found.by_task[1].robots == Ids{"arm"});
  CHECK(found.cover());
  CHECK(why(found, "arm") == "has no skill 'go_to' (task drive)");
  CHECK(why(found, "pioneer1") == "has no skill 'load_out' (task load)");
}

TEST_CASE("nobody at all: it is said for each robot why") {
  Fleet fleet = hall();
  fleet.on_fault("arm", {"carry", Severity::critical, "gripper"}, at_second(60));
  const Candidates found = find_candidates(fleet, {{load()}, {"ridgeback"}});
  CHECK(found.robots.empty());
  CHECK_FALSE(found.cover());
  CHECK(why(found, "arm") == "'carry' is broken since 2023-11-14T22:14:20.000Z: gripper (task load)");
}

TEST_CASE("what several tasks lack is said once, and cut only behind a word") {
  Fleet fleet = hall();
  const std::string text = "both wheels stalled; front bumper 1; the motors are off";
  fleet.on_fault("pioneer1", {"mobile", Severity::critical, text}, at_second(60));
  Needs needs{{}, {"ridgeback"}};
  for (const char* task : {"a", "b", "c", "d", "e"}) {
    needs.tasks.push_back(drive("dock"));
    needs.tasks.back().task = task;
  }
  const std::string said = "'mobile' is broken since 2023-11-14T22:14:20.000Z: " + text;
  CHECK(why(find_candidates(fleet, needs), "pioneer1") == said + " (tasks a, b, c and others)");
  needs.tasks.resize(2);
  CHECK(why(find_candidates(fleet, needs), "pioneer1") == said + " (tasks a, b)");

  fleet.on_fault("turtlebot",
                 {"mobile", Severity::critical, "the left wheel slips " + std::string(190, 'x') + " at the dock"},
                 at_second(60));
  const std::string cut = why(find_candidates(fleet, needs), "turtlebot");
  CHECK(cut.size() <= kMaxWhy);
  CHECK(cut.ends_with("the left wheel slips …"));
}

TEST_CASE("values and places must fit the robot's own skill") {
  const Fleet fleet = hall();
  const auto reason = [&](const TaskNeed& need) {
    const Candidates found = find_candidates(fleet, {{need}, {"turtlebot", "pioneer1", "arm"}});
    return found.robots.empty() ? why(found, "ridgeback") : "fits";
  };
  const auto is_near = [](double height) { return Value::Object{{"height", Value{height}}}; };
  CHECK(reason(drive("dock")) == "fits");
  CHECK(reason(drive("moon")) == "parameter 'place': 'moon' is no place that 'ridgeback' knows (task drive)");
  CHECK(reason({"t", "go_to", {}, {{"place", Value{std::int64_t{4}}}}, {}}) ==
        "parameter 'place': is a whole number, not a place (task t)");
  CHECK(reason({"t", "go_to", {}, {}, {}}) == "parameter 'place': it is required here (task t)");
  CHECK(reason({"t", "go_to", {}, {}, {"place"}}) == "fits");
  CHECK(reason({"t", "go_to", {}, {{"place", Value{std::string("dock")}}}, {"speed"}}) ==
        "parameter 'speed': its skill has none of that name (task t)");
  CHECK(reason(load(is_near(1.5))) == "fits");
  CHECK(reason(load(is_near(1.6))) == "parameter 'height': 1.6 is over 1.5 m (task load)");
  CHECK(reason(load(is_near(-1))) == "parameter 'height': -1 is under 0 m (task load)");
  CHECK(reason(load(is_near(kUnknown))) == "parameter 'height': is no finite number (task load)");
  CHECK(reason(load({{"side", Value{std::string("l")}}})) == "fits");
  CHECK(reason(load({{"side", Value{std::string("x")}}})) == "parameter 'side': 'x' is none of its words (task load)");
  CHECK(reason(load({{"depth", Value{1.0}}})) == "parameter 'depth': its skill has none of that name (task load)");
  CHECK(reason({"t", "load_out", {"fly"}, {}, {}}) == "has no capability 'fly' (task t)");
}

TEST_CASE("numbers, integers and flags: each as its type asks") {
  Fleet fleet;
  NodeProfile profile = mobile_robot();
  profile.skills = {{"s",
                     "mobile",
                     {{"joints", "numbers", false, "rad", {-1, 1}, {}, 2},
                      {"n", "integer", false, ""},
                      {"on", "bool", false, ""},
                      {"later", "of_a_newer_version", false, ""}},
                     false,
                     1}};
  REQUIRE(fleet.on_route(route_of("a", profile), at_second(0)));
  const auto unable = [&](const std::string& name, const std::string& json) {
    return why_unable(*fleet.find("a"), {"t", "s", {}, {{name, *parse_json(json)}}, {}});
  };
  CHECK(unable("joints", "[0.5, 1]").empty());
  CHECK(unable("joints", "[0.5]") == "parameter 'joints': has 1 numbers, not 2");
  CHECK(unable("joints", "[0.5, 2]") == "parameter 'joints': 2 is over 1 rad");
  CHECK(unable("joints", "[0.5, \"x\"]") != "");
  CHECK(unable("joints", "0.5") != "");
  CHECK(unable("n", "4").empty());
  for (const char* no_integer : {"4.0", "4.5"}) {  // as the robot's own node checks it
    CHECK(unable("n", no_integer) == "parameter 'n': is a number, not a whole number");
  }
  CHECK(unable("n", "1e300") != "");
  CHECK(unable("on", "true").empty());
  CHECK(unable("on", "1") != "");
  CHECK(unable("later", "{}").empty());
}

TEST_CASE("a scenario's task is asked for as it stands there") {
  Task task;
  task.id = "t4";
  task.skill = "go_to";
  task.requires_ = {"mobile"};
  task.data = R"({"place": "dock"})";
  const auto need = need_of(task);
  REQUIRE(need);
  CHECK(find_candidates(hall(), {{*need}, {}}).robots == Ids{"pioneer1", "ridgeback", "turtlebot"});
}

TEST_CASE("1,000 robots: those that fit, in the order of their ids, and a bounded number of reasons") {
  Fleet fleet;
  for (int i = 0; i < 3000; ++i) {
    const std::string number = std::to_string(10000 + i);
    REQUIRE(fleet.on_route(route_of("r" + number.substr(1), i % 3 == 0 ? carrier() : mobile_robot()), at_second(0)));
  }
  const Candidates found = find_candidates(fleet, {{drive("dock"), load()}, {}});
  REQUIRE(found.robots.size() == 1000);
  CHECK(found.robots.front() == "r0000");
  CHECK(found.robots.back() == "r2997");
  CHECK(std::is_sorted(found.robots.begin(), found.robots.end()));
  CHECK(found.unsuitable.size() == kMaxUnsuitable);
  CHECK(found.others == 1000);
}
