#include "common/model/own_parameters.hpp"

#include <doctest/doctest.h>

#include <utility>

using namespace trb;
using namespace trb::model;

namespace {

Task task_of(const std::string& robot, std::vector<std::uint16_t> after = {}) {
  Task out;
  out.robot = robot;
  out.skill = "work";
  out.after = std::move(after);
  return out;
}

Scenario scenario_of(std::vector<Task> tasks) {
  Scenario out{.name = "tasks", .tasks = std::move(tasks)};
  for (std::size_t i = 0; i < out.tasks.size(); ++i) out.tasks[i].id = "t" + std::to_string(i);
  return out;
}

}  // namespace

TEST_CASE("in turn with five robots each is let go between its tasks, with three it is kept") {
  // Five robots pause for 12 s between their tasks, three for 6 s.
  CHECK(own_parameters_of(tasks_in_turn(5, 9), {}, 3) ==
        OwnParameters{.robots = 5, .tasks = 9, .members = 5, .batons = 9, .spells = 9, .seconds = 37});
  CHECK(own_parameters_of(tasks_in_turn(3, 9), {}, 3) ==
        OwnParameters{
            .robots = 3, .tasks = 9, .members = 3, .batons = 9, .spells = 3, .kept = 6, .resumed = 6, .seconds = 37});
}

TEST_CASE("one robot alone gets one baton, and its tasks follow each other") {
  CHECK(own_parameters_of(tasks_in_turn(1, 4), {}, 3) ==
        OwnParameters{.robots = 1, .tasks = 4, .members = 1, .batons = 1, .spells = 1, .seconds = 22});
}

TEST_CASE("a baton goes once to each robot that follows, when the last task before it is done") {
  // a and b begin; c waits for both tasks of a and for b's.
  const Scenario fan = scenario_of({task_of("a"), task_of("b"), task_of("a", {0}), task_of("c", {0, 1, 2})});
  const OwnParameters p = own_parameters_of(fan, {}, 2);
  CHECK(p.batons == 4);  // to a, to b, of b to c, of a to c
  CHECK(p.twice == 0);   // b is done before a
  CHECK(p.members == 3);
  CHECK(p.spells == 3);
  CHECK(p.seconds == 16);
}

TEST_CASE("a robot that gets its first batons of two at the same moment asks both for the definition") {
  CHECK(own_parameters_of(scenario_of({task_of("a"), task_of("b"), task_of("c", {0, 1})}), {}, 2).twice == 1);
}

TEST_CASE("a task may take its own time, or its skill's") {
  Scenario scenario = scenario_of({task_of("a"), task_of("b", {0}), task_of("a", {1})});
  scenario.tasks[1].skill = "wait";
  CHECK(task_times(scenario, {{"wait", 20}, {"task:t2", 5}}, 3) == std::vector<double>{3, 20, 5});
  // Its robot is let go while the other one waits.
  CHECK(own_parameters_of(scenario, {}, task_times(scenario, {}, 3)).spells == 2);
  CHECK(own_parameters_of(scenario, {}, task_times(scenario, {{"wait", 20}}, 3)).spells == 3);
}

TEST_CASE("whoever evaluates a condition gets the batons, and gives them to the task's robot") {
  Scenario scenario = scenario_of({task_of("a"), task_of("b"), task_of("c", {0, 1}), task_of("a", {0, 1})});
  scenario.tasks[2].when = {Condition{.sensor = "light", .of = "a"}};
  scenario.tasks[3].when = {Condition{.sensor = "light", .of = "c"}};
  const OwnParameters p = own_parameters_of(scenario, {}, 1);
  CHECK(p.batons == 4);  // to a, to b; of b to a, of a to c
  CHECK(p.remote_requests == 1);
}

TEST_CASE(
    "a task that names no robot goes by the cloud: a baton of each robot before it, and then to whom it gives it") {
  Scenario scenario = scenario_of({task_of("a"), task_of("b"), task_of("", {0, 1}), task_of("a", {2})});
  scenario.tasks[2].requires_ = {"carry"};
  const OwnParameters to_b = own_parameters_of(scenario, {"", "", "b", ""}, 1);
  CHECK(to_b.bound == 1);
  CHECK(to_b.robots == 2);
  // To a, to b; of both to the cloud, of a to b; of b to a. The cloud's own comes with its decision.
  CHECK(to_b.batons == 6);
  CHECK(batons(to_b) == 7);
  CHECK(own_parameters_of(scenario, {}, 1).robots == 3);
}

TEST_CASE("a robot whose tasks are all done asks for the run's end after 30 s, and then ever more seldom") {
  CHECK(own_parameters_of(tasks_in_turn(4, 20), {}, 30).end_asked == 4);  // 90 s before it two, 60 s one, 30 s one
  CHECK(own_parameters_of(tasks_in_turn(5, 5), {}, 15).end_asked == 3);
  CHECK(own_parameters_of(tasks_in_turn(2, 2), {}, 29).end_asked == 0);
  CHECK(own_parameters_of(tasks_in_turn(2, 2), {}, 1000).end_asked == 5);  // at 30, 90, 210, 450, 930 s
  // The cloud gives a another task when it is due: a does not know before.
  Scenario late = scenario_of({task_of("a"), task_of("b", {0}), task_of("", {1})});
  CHECK(own_parameters_of(late, {"", "", "a"}, 40).end_asked == 2);  // of a while b works, of b while a does
  late.tasks[2].robot = "a";
  CHECK(own_parameters_of(late, {}, 40).end_asked == 1);
}
