#include "common/scenario/candidate_index.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <limits>

#include "common/scenario/definition.hpp"
#include "common/scenario/repeat.hpp"
#include "common/scenario/test/candidate_hall.hpp"

using namespace trb;

namespace {

/// Two carts, a carrier, and the cloud.
Profiles hall() {
  return {{"cloud", {}}, {"pioneer1", cart()}, {"pioneer2", cart({"dock"})}, {"ridgeback", carrier()}};
}

Task named(std::string robot, std::string skill = "go_to", std::string data = R"({"place":"dock"})") {
  Task out = late({}, std::move(skill), std::move(data));
  out.robot = std::move(robot);
  return out;
}

ConfigFaults check(const Task& task, const Profiles& profiles = hall()) {
  ConfigFaults faults;
  check_scenario({"n", "", {task}}, profiles, "s.json", faults);
  for (const ConfigFault& fault : faults) CHECK_FALSE(fault.hint.empty());
  return faults;
}

std::string bound(const Task& task, const Profiles& profiles = hall()) {
  CandidateIndex candidates(profiles);
  ConfigFaults faults;
  const auto robots = bind_tasks({"n", "", {task}}, candidates, "", "s.json", faults);
  REQUIRE(robots.size() == 1);
  CHECK(robots[0].empty() == !faults.empty());
  return faults.empty() ? robots[0] : faults[0].what;
}

/// "": there is a spare.
std::string why_alone(const Task& task, const Profiles& profiles = hall()) {
  CandidateIndex candidates(profiles);
  const auto without = tasks_without_spare({"n", "", {task}}, candidates);
  return without.empty() ? "" : without[0].robot + ": " + without[0].why;
}

}  // namespace

TEST_CASE("a value out of its range, none of the words, or too many numbers") {
  CHECK(check(named("pioneer1", "go_to", R"({"place":"dock","speed":1})")).empty());
  const auto fast = check(named("pioneer1", "go_to", R"({"place":"dock","speed":3})"));
  REQUIRE(fast.size() == 1);
  CHECK(fast[0].what == "task 't': 3 is over 1 m/s");
  CHECK(fast[0].hint == R"(use "speed": a number from 0.1 to 1 in m/s)");
  const auto word = check(named("ridgeback", "load_out", R"({"side":"lfet"})"));
  CHECK(word.at(0).key == "tasks[0].data.side");
  CHECK(word.at(0).hint == "did you mean 'left'?");
  Profiles profiles = hall();
  auto& parameters = profiles["pioneer1"].skills[0].parameters;
  parameters.push_back({"joints", "numbers", false, "rad", {-1, std::numeric_limits<double>::max()}, {}, 2});
  const auto joints = [&](const std::string& list) {
    return check(named("pioneer1", "go_to", R"({"place":"dock","joints":)" + list + "}"), profiles);
  };
  CHECK(joints("[0, 1e9]").empty());
  CHECK(joints("[0]").at(0).what == "task 't': has 1 numbers, not 2");
  CHECK(joints("[0, -2]").at(0).hint == R"(use "joints": a list of 2 numbers from -1 on in rad)");
}

TEST_CASE("a value that comes from a result: its parameter must exist, and is not missing") {
  Task task = named("pioneer1", "go_to", "{}");
  CHECK(check(task).at(0).key == "tasks[0].data.place");
  task.values = {{"place", "scan", ""}};
  CHECK(check(task).empty());
  task.values.push_back({"spede", "scan", ""});
  CHECK(check(task).at(0).key == "tasks[0].data.spede");
  CHECK(check(task).at(0).hint == "did you mean 'speed'?");
}

TEST_CASE("a robot that is named has what the task requires, too") {
  Task task = named("pioneer1");
  task.requires_ = {"mobile"};
  CHECK(check(task).empty());
  task.requires_ = {"mobile", "carry"};
  const auto faults = check(task);
  REQUIRE(faults.size() == 1);
  CHECK(faults[0].key == "tasks[0].requires");
  CHECK(faults[0].what == "task 't': 'pioneer1' has no capability 'carry'");
}

TEST_CASE("a task that is bound late: somebody of the fleet must be able, online or not") {
  CHECK(check(late({"mobile"})).empty());
  Profiles asleep = hall();
  for (auto& [id, profile] : asleep) profile.robot = "OFFLINE";
  CHECK(check(late({"mobile"}), asleep).empty());
  CHECK(check(late({"mobiel"})).at(0).hint == "did you mean 'mobile'?");
  CHECK(check(late({"mobile"}, "goto")).at(0).hint == "did you mean 'go_to'?");
  const auto both = check(late({"fly"}, "goto"));
  REQUIRE(both.size() == 2);
  CHECK(both[0].key == "tasks[0].skill");
  CHECK(both[1].key == "tasks[0].requires");
  const auto nowhere = check(late({"mobile"}, "go_to", R"({"place":"moon"})"));
  REQUIRE(nowhere.size() == 1);
  CHECK(nowhere[0].what.find("'pioneer1': place 'moon' is no place that 'pioneer1' knows; 'pioneer2': ") !=
        std::string::npos);
  Profiles without = hall();
  without["pioneer1"].capabilities = {"carry"};
  without["ridgeback"].skills.clear();
  CHECK(check(late({"carry", "mobile"}), without).at(0).what.find("'pioneer1' has no capability 'mobile'") !=
        std::string::npos);
}

TEST_CASE("bound late: the first by id that is online, not stopped, and able") {
  CHECK(bound(named("ridgeback")) == "ridgeback");
  CHECK(bound(late({"mobile"})) == "pioneer1");
  CHECK(bound(late({"mobile", "carry"})) == "ridgeback");
  Profiles profiles = hall();
  profiles["pioneer1"].robot = "CONNECTION_BROKEN";
  CHECK(bound(late({"mobile"}), profiles) == "pioneer2");
  CHECK(bound(late({"mobile"}, "go_to", R"({"place":"table1"})"), profiles) == "ridgeback");
  profiles["ridgeback"].fenced = true;
  CHECK(bound(late({"mobile"}, "go_to", R"({"place":"table1"})"), profiles) ==
        "task 't': nobody can do it now: 'pioneer1' is CONNECTION_BROKEN; 'ridgeback' is stopped until it is released; "
        "'pioneer2': place 'table1' is no place that 'pioneer2' knows");
}

TEST_CASE("where somebody decides, who does it is left until it is due: of so many tasks as a run has decisions for") {
  const Profiles profiles = hall();
  CandidateIndex candidates(profiles);
  ConfigFaults faults;
  Scenario scenario{"n", "", {named("pioneer2"), late({"fly"}), late({"mobile"})}};
  using Robots = std::vector<std::string>;
  CHECK(bind_tasks(scenario, candidates, "cloud", "s.json", faults) == Robots{"pioneer2", "cloud", "cloud"});
  CHECK(faults.empty());  // a robot that flies may come
  scenario.tasks = repeat_tasks({late({"mobile"})}, kMaxBoundWhenDue + 1);
  const Robots robots = bind_tasks(scenario, candidates, "cloud", "s.json", faults);
  CHECK(robots[0] == "pioneer1");  // among equals, the task that begins last is left to the decider
  CHECK(std::ranges::count(robots, "cloud") == kMaxBoundWhenDue);
  CHECK(faults.empty());
  scenario.tasks = repeat_tasks({late({"fly"})}, kMaxBoundWhenDue + 5);
  bind_tasks(scenario, candidates, "cloud", "s.json", faults);
  CHECK(faults.size() == 1);
}

TEST_CASE("the decider is left first what nobody can do now, then what several could do") {
  Profiles profiles = hall();
  Scenario scenario{"n", "", {}};
  const auto add = [&](Task task, const char* kind) {
    task.id = kind + std::to_string(scenario.tasks.size());
    scenario.tasks.push_back(std::move(task));
  };
  for (int i = 0; i < 20; ++i) add(late({"carry"}), "one");
  for (int i = 0; i < 20; ++i) add(late({"mobile"}), "several");
  profiles["drone"] = cart();
  profiles["drone"].capabilities = {"fly"};
  profiles["drone"].robot = "OFFLINE";
  for (int i = 0; i < 20; ++i) add(late({"fly"}), "nobody");
  CandidateIndex candidates(profiles);
  ConfigFaults faults;
  const auto robots = bind_tasks(scenario, candidates, "cloud", "s.json", faults);
  CHECK(faults.empty());
  std::map<std::string, int> left;
  for (std::size_t i = 0; i < robots.size(); ++i)
    left[scenario.tasks[i].id.substr(0, 3)] += robots[i] == "cloud" ? 1 : 0;
  CHECK(left == std::map<std::string, int>{{"nob", 20}, {"one", 0}, {"sev", 12}});
}

TEST_CASE("what is bound at once is spread: the fewest tasks of this run, then by id") {
  const Profiles profiles = hall();
  Scenario scenario{"n", "", {named("pioneer1"), named("pioneer1")}};
  for (int i = 0; i < 7; ++i) scenario.tasks.push_back(late({"mobile"}));
  for (std::size_t i = 0; i < scenario.tasks.size(); ++i) scenario.tasks[i].id = "t" + std::to_string(i);
  CandidateIndex candidates(profiles);
  ConfigFaults faults;
  using Robots = std::vector<std::string>;
  CHECK(bind_tasks(scenario, candidates, "", "s.json", faults) == Robots{"pioneer1", "pioneer1", "pioneer2",
                                                                         "ridgeback", "pioneer2", "ridgeback",
                                                                         "pioneer1", "pioneer2", "ridgeback"});
}

TEST_CASE("a robot that is retired or out of use is no spare and gets no task, and the check warns of it") {
  Profiles profiles = hall();
  profiles["pioneer1"].out_of_use = {{"", Severity::critical, "new wheels", 0, true, "ann"}};
  profiles["pioneer2"].out_of_use = {{"mobile", Severity::critical, "a wheel is off", 0, false, ""}};
  CHECK(bound(late({"mobile"}), profiles) == "ridgeback");
  CHECK(why_alone(named("ridgeback"), profiles) ==
        "ridgeback: 'pioneer1' is retired by ann: new wheels; 'pioneer2' cannot use 'mobile': a wheel is off");
  const auto warned = [&](const Scenario& scenario) {
    ConfigFaults faults;
    warn_of_robots(scenario, profiles, "s.json", faults);
    CHECK(faults_that_stop(faults).empty());
    std::string out;
    for (const ConfigFault& fault : faults) out += fault.key + ": " + fault.what + "\n";
    return out;
  };
  CHECK(warned({"n", "", {named("ridgeback"), late({"mobile"}), named("nobody")}}).empty());
  CHECK(warned({"n", "", {named("pioneer1"), named("pioneer1"), named("pioneer2")}}) ==
        "tasks[0].robot: task 't': 'pioneer1' is retired by ann: new wheels\n"
        "tasks[2].robot: task 't': 'pioneer2' cannot use 'mobile': a wheel is off\n");
  profiles["pioneer1"].out_of_use.clear();
  profiles["pioneer1"].robot = "OFFLINE";
  profiles["pioneer2"].fenced = true;
  CHECK(warned({"n", "", {named("pioneer1"), named("pioneer2")}}) ==
        "tasks[0].robot: task 't': 'pioneer1' is OFFLINE\n"
        "tasks[1].robot: task 't': 'pioneer2' is stopped until it is released\n");
  profiles["ridgeback"].out_of_use = {{"carry", Severity::fatal, "gripper jammed", 0, false, ""}};
  CHECK(warned({"n", "", {named("ridgeback")}}).empty());  // it can still drive
  Task carries = named("ridgeback");
  carries.requires_ = {"carry"};
  CHECK_FALSE(warned({"n", "", {carries}}).empty());
}

TEST_CASE("the preflight tells what nobody else could do now, and why") {
  CHECK(why_alone(named("ridgeback")) == "");
  CHECK(why_alone(late({"mobile"})) == "");
  CHECK(why_alone(named("ridgeback", "load_out", R"({"side":"left"})")) ==
        "ridgeback: no other robot has the skill 'load_out'");
  CHECK(why_alone(late({"mobile", "carry"})) ==
        "ridgeback: 'pioneer1' has no capability 'carry'; 'pioneer2' has no capability 'carry'");
  Profiles profiles = hall();
  profiles["pioneer1"].robot = "OFFLINE";
  CHECK(why_alone(named("ridgeback", "go_to", R"({"place":"table1"})"), profiles) ==
        "ridgeback: 'pioneer1' is OFFLINE; 'pioneer2': place 'table1' is no place that 'pioneer2' knows");
  CHECK(why_alone(named("pioneer1", "go_to", R"({"place":"table1"})"), profiles) == "");
  Task pinned = named("ridgeback");
  pinned.pinned = true;
  CHECK(why_alone(pinned) == "ridgeback: it is pinned to its robot");
  Task late_and_pinned = late({"mobile"});
  late_and_pinned.pinned = true;
  CHECK(why_alone(late_and_pinned) == ": it stays with the robot that is chosen for it: it is pinned");
  late_and_pinned.requires_ = {"mobile", "carry"};
  CHECK(why_alone(late_and_pinned) == "ridgeback: it is pinned to its robot");  // there is one to choose
  late_and_pinned.requires_ = {"fly"};
  CHECK(why_alone(late_and_pinned).find("pinned") == std::string::npos);
  profiles["ridgeback"].robot = "OFFLINE";
  CHECK(why_alone(late({"carry"}), profiles).starts_with(": 'ridgeback' is OFFLINE; "));
}

TEST_CASE("the rounds of a repeated scenario are told once") {
  Scenario scenario{"n", "", {named("ridgeback", "load_out", R"({"side":"up"})")}};
  scenario.tasks = repeat_tasks(scenario.tasks, 5);
  const Profiles profiles = hall();
  ConfigFaults faults;
  check_scenario(scenario, profiles, "s.json", faults);
  CHECK(faults.size() == 1);
  CandidateIndex candidates(profiles);
  CHECK(tasks_without_spare(scenario, candidates).size() == 1);
  scenario.tasks = repeat_tasks({late({"fly"})}, 3);
  CHECK(bind_tasks(scenario, candidates, "", "s.json", faults) == std::vector<std::string>(3));
  CHECK(faults.size() == 2);
}
