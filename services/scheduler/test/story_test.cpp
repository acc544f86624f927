// Whole runs, over several cores, in virtual time.
#include <doctest/doctest.h>

#include <algorithm>

#include "services/scheduler/test/crashes.hpp"

using namespace trb;
using namespace trb::scheduler::test;

namespace {

void submit(Fleet& fleet, const Scenario& scenario, const std::string& node = "cloud", Duration life = seconds(3600)) {
  fleet.ask(node, MessageType::command, RunSubmit{fleet.make_start(scenario, node, life, kRun)});
}

bool is(Fleet& fleet, const std::string& node, RunState state) {
  return fleet.view(node, kRun).state == state;
}

auto finished_at(Fleet& fleet, const std::string& node) {
  return [&fleet, node] { return is(fleet, node, RunState::finished); };
}

/// Every attempt that any robot ever began, over all instances.
std::map<std::string, int> begun(Fleet& fleet) {
  std::map<std::string, int> out;
  for (const char* robot : {"conveyor", "drone", "pioneer", "ridgeback", "ur3"}) {
    for (const auto& [key, times] : fleet[robot].adapter.begun) out[key.second.task] += times;
  }
  return out;
}

/// How many of its deliveries the node's journal knows to be acknowledged.
std::size_t acknowledged(const Node& node) {
  return static_cast<std::size_t>(std::ranges::count_if(
      node.journal, [](const auto& one) { return std::holds_alternative<scheduler::JournalDelivered>(one); }));
}

void check_each_once(Fleet& fleet) {
  const auto times = begun(fleet);
  CHECK(times.size() == 9);
  for (const auto& one : times) CHECK_MESSAGE(one.second == 1, one.first);
}

}  // namespace

TEST_CASE("the demonstration passes from robot to robot and each task is done once") {
  Fleet fleet;
  add_demonstration(fleet);
  submit(fleet, nine_tasks());
  REQUIRE(fleet.answers.size() == 1);
  CHECK(get<RunAccepted>(fleet.answers[0]).run == kRun);
  REQUIRE(fleet.until(finished_at(fleet, "cloud")));
  check_each_once(fleet);
  fleet.pass(seconds(5));
  // One baton to the first actor and one at each change of actor (the fork and the join make it nine in all).
  CHECK(fleet.carried["baton"] == 10);  // and the cloud's
  CHECK(fleet.carried["results"] == 9);
  CHECK(fleet.carried["results_journaled"] == 9);
  CHECK(fleet.carried["need_results"] == 0);
  const RunView view = fleet.view("cloud", kRun);
  CHECK(view.waits_for.empty());
  CHECK(view.tasks[8].state == TaskState::finished);
  CHECK(view.tasks[8].duration_s == doctest::Approx(1));
}

TEST_CASE("the end of a step looks at the run that its message is about, however many are open") {
  Fleet fleet;
  add_demonstration(fleet);
  fleet["ur3"].adapter.skill_time = seconds(1000);
  std::string run;
  for (int number = 10; number < 30; ++number) {
    run = std::string(30, 'a') + std::to_string(number);
    fleet.ask("cloud", MessageType::command,
              RunSubmit{fleet.make_start(chain({"ur3", "drone"}), "cloud", seconds(3600), run)});
  }
  fleet.pass(seconds(45));
  const auto visits = [&](const std::string& node, const Body& body) {
    const std::uint64_t before = fleet[node].core->visits();
    fleet.hear(node, node == "cloud" ? "ur3" : "cloud", MessageType::information, body);
    return fleet[node].core->visits() - before;
  };
  const BatonJournaled late{run, 1, {1}, true};
  CHECK(visits("cloud", late) == 1);
  CHECK(visits("ur3", late) == 2);  // and at the run of the attempt
  const AttemptKey key{run, "task-0", 1, 1};
  CHECK(visits("cloud", TaskProgress{key, "ur3", TaskState::running, ""}) == 1);
  CHECK(fleet.view("cloud", run).tasks[0].state == TaskState::running);
}

TEST_CASE("that a delivery was acknowledged costs no commit of its own") {
  Fleet fleet;
  add_demonstration(fleet);
  submit(fleet, nine_tasks());
  REQUIRE(fleet.until(finished_at(fleet, "cloud")));
  fleet.pass(seconds(5));
  // A robot writes each start (the first with the run), each result, at the join another's result, and that the run is
  // over; the cloud writes each result.
  const std::map<std::string, std::size_t> expected = {{"cloud", 11},  {"conveyor", 3},  {"drone", 5},
                                                       {"pioneer", 6}, {"ridgeback", 5}, {"ur3", 5}};
  for (const auto& [node, commits] : expected) CHECK_MESSAGE(fleet[node].commits == commits, node);
}

TEST_CASE("that a delivery was acknowledged is on disk in time, though nothing else is written") {
  Fleet fleet;
  add_demonstration(fleet);
  fleet["drone"].adapter.skill_time = seconds(100);
  submit(fleet, chain({"ur3", "drone"}));
  REQUIRE(
      fleet.until([&] { return fleet.carried["baton_journaled"] == 2 && fleet.carried["results_journaled"] == 1; }));
  fleet.pass(seconds(1));
  CHECK(acknowledged(fleet["ur3"]) == 0);
  fleet.pass(JournalQueue::kLongest);
  CHECK(acknowledged(fleet["ur3"]) == 2);
}

TEST_CASE(
    "what a node had delivered when it died, and not on disk, is sent again and answered, and nothing done twice") {
  Fleet fleet;
  add_demonstration(fleet);
  submit(fleet, chain({"ur3", "drone"}));
  REQUIRE(
      fleet.until([&] { return fleet.carried["baton_journaled"] == 2 && fleet.carried["results_journaled"] == 1; }));
  fleet.pass(seconds(0.1));
  REQUIRE(acknowledged(fleet["ur3"]) == 0);
  fleet.stop("ur3");
  fleet.start("ur3");
  fleet.pass(seconds(0.1));
  CHECK(fleet.carried["baton"] == 3);
  CHECK(fleet.carried["baton_journaled"] == 3);
  CHECK(fleet.carried["results"] == 2);
  CHECK(fleet.carried["results_journaled"] == 2);
  REQUIRE(fleet.until(finished_at(fleet, "cloud")));
  for (const auto& [task, times] : begun(fleet)) CHECK_MESSAGE(times == 1, task);
  CHECK(fleet.counted["double_execution"] == 0);
}

TEST_CASE("progress is told while a task runs") {
  Fleet fleet;
  add_demonstration(fleet);
  submit(fleet, nine_tasks());
  CHECK(fleet.until([&] { return fleet.view("cloud", kRun).tasks[0].state == TaskState::running; }, seconds(1)));
  CHECK(fleet.view("ridgeback", kRun).tasks[0].state == TaskState::running);
  CHECK(fleet.view("cloud", kRun).tasks[1].state == TaskState::waiting);
}

TEST_CASE("loss, repetition and disorder of every message do no harm") {
  for (std::uint64_t seed = 1; seed <= 12; ++seed) {
    CAPTURE(seed);
    Fleet fleet(seed);
    add_demonstration(fleet);
    fleet.weather = {300, 200, 150, seconds(0.8)};
    submit(fleet, nine_tasks());
    REQUIRE(fleet.until(finished_at(fleet, "cloud")));
    check_each_once(fleet);
    CHECK(fleet.counted["double_execution"] == 0);
  }
}

TEST_CASE("the same seed gives the same story") {
  const auto story = [] {
    Fleet fleet(7);
    add_demonstration(fleet);
    fleet.weather = {200, 200, 100, seconds(0.5)};
    submit(fleet, nine_tasks());
    fleet.until(finished_at(fleet, "cloud"));
    return std::pair(fleet.now().mono.ns, fleet.carried);
  };
  CHECK(story() == story());
}

TEST_CASE("a scheduler may die after any of its records and nothing is done twice or lost") {
  die_at_every_record({"ridgeback", "ur3", "pioneer", "cloud"}, 100, [](const auto& victim, const Doom& doom) {
    Fleet fleet;
    add_demonstration(fleet);
    doom(fleet);
    submit(fleet, nine_tasks());
    // A submitter that died before it could answer is asked again by its person.
    if (fleet.answers.empty()) fleet.until([&] { return fleet["cloud"].up; });
    REQUIRE(fleet.until([&] { return fleet["cloud"].up && is(fleet, "cloud", RunState::finished); }));
    check_each_once(fleet);
    for (const auto& [key, times] : fleet[victim].adapter.commanded) CHECK(times == 1);
    fleet.pass(seconds(10));
    return fleet[victim].crash.commits;
  });
}

TEST_CASE("dying in bad weather does no harm either") {
  for (std::size_t k = 1; k <= 10; ++k) {
    CAPTURE(k);
    Fleet fleet(k);
    add_demonstration(fleet);
    fleet.weather = {200, 200, 100, seconds(0.5)};
    for (const char* robot : {"ridgeback", "ur3", "drone"}) fleet[robot].crash.at = k;
    submit(fleet, nine_tasks());
    REQUIRE(fleet.until(finished_at(fleet, "cloud")));
    check_each_once(fleet);
  }
}

TEST_CASE("a mode-adapter that starts anew while a task runs leaves it to a person") {
  Fleet fleet;
  add_demonstration(fleet);
  submit(fleet, nine_tasks());
  REQUIRE(fleet.until([&] { return !fleet["ur3"].adapter.begun.empty(); }));
  fleet.pass(seconds(0.2));
  fleet["ur3"].adapter.restart();
  REQUIRE(fleet.until([&] { return is(fleet, "cloud", RunState::paused); }));
  const RunView view = fleet.view("cloud", kRun);
  CHECK(view.tasks[2].state == TaskState::retriable);
  CHECK(view.tasks[2].outcome == TaskOutcome::interrupted);
  CHECK(view.waits_for.find("put_down") != std::string::npos);
  CHECK(view.waits_for.find("ur3") != std::string::npos);
  CHECK(view.waits_for.find("person") != std::string::npos);
  fleet.pass(seconds(60));
  CHECK(is(fleet, "ur3", RunState::paused));
  CHECK(begun(fleet).size() == 3);
  CHECK(begun(fleet)["put_down"] == 1);
}

TEST_CASE("a failed task pauses the run and says where and why") {
  Fleet fleet;
  add_demonstration(fleet);
  fleet["conveyor"].adapter.ending = TaskOutcome::failed;
  submit(fleet, nine_tasks());
  REQUIRE(fleet.until([&] { return is(fleet, "cloud", RunState::paused); }));
  CHECK(fleet.view("cloud", kRun).waits_for == "task 'move_box' failed on 'conveyor': the gripper is stuck");
  CHECK(fleet.view("conveyor", kRun).tasks[1].state == TaskState::failed);
  fleet.pass(seconds(60));
  CHECK(begun(fleet).size() == 2);
}

TEST_CASE("with the cloud gone the robots finish, and it learns everything when it is back") {
  Fleet fleet;
  add_demonstration(fleet);
  submit(fleet, nine_tasks(), "ridgeback");
  fleet.stop("cloud");
  REQUIRE(fleet.until([&] { return begun(fleet).size() == 9; }));
  fleet.pass(seconds(4 * 60));
  const int before = fleet.carried["results"];
  fleet.pass(seconds(60));
  CHECK(fleet.carried["results"] - before < 5 * 40);  // five robots, at most every 2 s, however much they owe
  fleet.start("cloud");
  REQUIRE(fleet.until(finished_at(fleet, "cloud"), seconds(5)));
  check_each_once(fleet);
}

TEST_CASE("a submitter that is gone after its acceptance is not missed, nor is its word to the cloud") {
  Fleet fleet;
  add_demonstration(fleet);
  fleet["cloud"].cut = true;
  submit(fleet, nine_tasks(), "ridgeback");
  REQUIRE(fleet.until([&] { return begun(fleet).size() == 2; }));
  fleet["cloud"].cut = false;
  fleet["ridgeback"].cut = true;
  REQUIRE(fleet.until([&] { return begun(fleet).contains("go_back"); }));
  fleet.pass(seconds(5));
  // It has the definition and every other result from the robots.
  CHECK(fleet.view("cloud", kRun).tasks[6].state == TaskState::finished);
  fleet["ridgeback"].cut = false;
  REQUIRE(fleet.until(finished_at(fleet, "cloud")));
  check_each_once(fleet);
}

TEST_CASE("a run without a cloud acknowledges to its submitter") {
  Fleet fleet;
  for (const char* robot : {"ridgeback", "ur3"}) fleet.add(robot, Role::robot);
  submit(fleet, chain({"ur3", "ridgeback", "ur3"}), "ridgeback");
  REQUIRE(fleet.until(finished_at(fleet, "ridgeback")));
  CHECK(fleet.carried["results"] == 2);
}

TEST_CASE("a fenced or absent robot waits, says why, and goes on") {
  Fleet fleet;
  add_demonstration(fleet);
  fleet["ridgeback"].adapter.set(true, true);
  fleet.pass(seconds(1));
  Scenario scenario = chain({"ridgeback", "ridgeback"});
  scenario.tasks[1].after.clear();
  scenario.tasks[1].pinned = true;
  submit(fleet, scenario);
  fleet.pass(seconds(5));
  // A person's stop holds for a pinned task too: it is not even tried.
  CHECK(fleet["ridgeback"].adapter.commanded.empty());
  CHECK(begun(fleet).empty());
  fleet["ridgeback"].adapter.set(false, true);
  fleet.pass(seconds(1));
  CHECK(fleet.view("ridgeback", kRun).state == RunState::running);
  CHECK(fleet.view("ridgeback", kRun).waits_for.find("CONNECTION_BROKEN") != std::string::npos);
  fleet["ridgeback"].adapter.set(true, false);
  REQUIRE(fleet.until(finished_at(fleet, "cloud")));
  CHECK(begun(fleet) == std::map<std::string, int>{{"task-0", 1}, {"task-1", 1}});
}

TEST_CASE("very many tasks at once are passed in several batons, each of which fits into a message") {
  Fleet fleet;
  add_demonstration(fleet);
  fleet["ridgeback"].adapter.set(true, true);  // fenced: it begins none of them
  fleet.pass(seconds(1));
  Scenario scenario = chain(std::vector<std::string>(130, "ridgeback"));
  for (Task& task : scenario.tasks) task.after.clear();
  submit(fleet, scenario);
  fleet.pass(seconds(5));
  CHECK(fleet.carried["baton_journaled"] == 3);  // 64, 64 and 2 tasks
  CHECK(fleet.carried["baton"] <= 2 * 3);        // sent again until it has the definition, too
}

TEST_CASE("a robot that another commands keeps its task waiting, says who it is, and goes on") {
  Fleet fleet;
  add_demonstration(fleet);
  fleet["ridgeback"].adapter.set_control("cloud");
  fleet.pass(seconds(1));
  submit(fleet, chain({"ridgeback", "ur3"}));
  fleet.pass(seconds(5));
  CHECK(begun(fleet).empty());
  CHECK(fleet.view("ridgeback", kRun).waits_for.find("controlled by 'cloud'") != std::string::npos);
  fleet["ridgeback"].adapter.set_control({});
  REQUIRE(fleet.until(finished_at(fleet, "cloud")));
  CHECK(begun(fleet) == std::map<std::string, int>{{"task-0", 1}, {"task-1", 1}});
}

TEST_CASE("a command that meets another's control lease was not begun: it is tried again") {
  Fleet fleet;
  add_demonstration(fleet);
  auto& adapter = fleet["ridgeback"].adapter;
  submit(fleet, chain({"ridgeback", "ur3"}));
  adapter.set_control("cloud");  // its word is still on the way when the command is given
  fleet.pass(seconds(5));
  CHECK(begun(fleet).empty());
  CHECK(fleet.view("ridgeback", kRun).waits_for.find("controlled by 'cloud'") != std::string::npos);
  adapter.set_control({});
  REQUIRE(fleet.until(finished_at(fleet, "cloud")));
  CHECK(begun(fleet) == std::map<std::string, int>{{"task-0", 1}, {"task-1", 1}});
}

TEST_CASE("two runs share a robot, one task at a time") {
  Fleet fleet;
  add_demonstration(fleet);
  submit(fleet, nine_tasks());
  const std::string other(32, 'b');
  fleet.ask("cloud", MessageType::command, RunSubmit{fleet.make_start(nine_tasks(), "cloud", seconds(3600), other)});
  REQUIRE(fleet.until([&] {
    return is(fleet, "cloud", RunState::finished) && fleet.view("cloud", other).state == RunState::finished;
  }));
  for (const auto& one : begun(fleet)) CHECK_MESSAGE(one.second == 2, one.first);
}
