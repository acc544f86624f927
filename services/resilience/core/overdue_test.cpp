#include "services/resilience/core/overdue.hpp"

#include <doctest/doctest.h>

#include "services/resilience/test/fleet_fixture.hpp"

using namespace trb;
using namespace trb::resilience;

namespace {

Now hall_time(double s) {
  return {MonotonicTime{} + seconds(s), at_second(0)};
}

struct Hall {
  Fleet fleet;
  WatchedRun run;
  Overdue::Runs runs;  ///< the others
  Overdue overdue;
  Hall() {
    REQUIRE(fleet.on_route(route_of("r1", mobile_robot()), at_second(0)));  // go_to takes 120 s at most
    run.summary.run = "run1";
    run.view.emplace();
    run.start.emplace();
    for (const char* id : {"t1", "t2"}) {
      Task task;
      task.id = id;
      task.robot = "r1";
      task.skill = "go_to";
      run.start->scenario.tasks.push_back(task);
      TaskView shown;
      shown.id = id;
      shown.robot = "r1";
      run.view->tasks.push_back(shown);
    }
  }
  TaskView& t1() { return run.view->tasks[0]; }
  Task& task() { return run.start->scenario.tasks[0]; }
  void see(double s) { overdue.follow(run, {}, runs, fleet, hall_time(s)); }
  /// By a view of that time.
  bool late(double s) { return !late_at(s).empty(); }
  std::vector<Overdue::Late> late_at(double s) {
    run.view_as_of = hall_time(s).mono;
    return overdue.late(run, fleet);
  }
  std::vector<std::size_t> to_skip(double s) {
    run.view_as_of = hall_time(s).mono;
    return overdue.to_skip(run);
  }
};

}  // namespace

TEST_CASE("a task that runs is late past its time-out and half of it, or 10 s") {
  Hall hall;
  hall.t1().state = TaskState::running;
  hall.see(0);
  CHECK_FALSE(hall.late(179));
  CHECK(hall.late(180));  // the skill's 120 s
  CHECK(hall.overdue.next(hall.run, hall.fleet, hall_time(5)) == hall_time(180).mono);
  CHECK_FALSE(hall.overdue.next(hall.run, hall.fleet, hall_time(180)));
  hall.task().timeout_s = 4;  // its own
  CHECK_FALSE(hall.late(13));
  CHECK(hall.late(14));
  hall.t1().attempt = 2;  // tried again: its time starts anew
  hall.see(100);
  CHECK_FALSE(hall.late(113));
  CHECK(hall.late(114));
  hall.t1().outcome = TaskOutcome::finished;
  hall.see(120);
  CHECK_FALSE(hall.late(1000));
}

TEST_CASE("without a time-out a task may run for ever") {
  Hall hall;
  NodeProfile profile = mobile_robot();
  profile.skills[0].timeout_s = 0;
  REQUIRE(hall.fleet.on_route(route_of("r1", profile), at_second(1)));
  hall.t1().state = TaskState::running;
  hall.see(0);
  CHECK_FALSE(hall.late(1e6));
}

TEST_CASE("a task that is due for 30 s is late; one that is not due, or of a run that is held, is not") {
  Hall hall;
  hall.see(0);
  CHECK_FALSE(hall.late(1000));
  hall.t1().due = true;
  hall.t1().waits_for = "run 17 to give r1 back";
  hall.see(1000);
  CHECK_FALSE(hall.late(1029));
  REQUIRE(hall.late(1030));
  CHECK(hall.late_at(1030)[0].text ==
        "task 't1' is due for 30 s and r1 has not begun it: it waits for run 17 to give r1 back");
  hall.run.view->paused_by = "ann";
  hall.see(1031);
  CHECK_FALSE(hall.late(1100));
  hall.run.view->paused_by.clear();
  hall.see(1100);  // a task that was held gets its full time again
  CHECK_FALSE(hall.late(1129));
  CHECK(hall.late(1130));
}

TEST_CASE("what was late before a restart is late after it, as long as it is the first thing that is seen") {
  Hall hall;
  hall.t1().state = TaskState::running;
  hall.overdue.follow(hall.run, {"t1"}, {}, hall.fleet, hall_time(0));
  CHECK(hall.late(0));
  hall.t1().attempt = 2;
  hall.overdue.follow(hall.run, {"t1"}, {}, hall.fleet, hall_time(1));
  CHECK_FALSE(hall.late(1));
}

TEST_CASE("a task that did not begin in time is to be skipped once, if its scenario does without it") {
  Hall hall;
  hall.t1().due = true;
  hall.task().start_within_s = 20;
  hall.see(0);
  CHECK(hall.to_skip(100).empty());  // on_failure resilience: people decide
  for (const OnFailure way : {OnFailure::skip, OnFailure::continue_}) {
    hall.task().on_failure = way;
    CHECK(hall.to_skip(24).empty());
    CHECK(hall.to_skip(25) == std::vector<std::size_t>{0});
  }
  hall.task().on_failure = OnFailure::abort;
  CHECK(hall.to_skip(25).empty());
  hall.task().on_failure = OnFailure::skip;
  hall.overdue.ruled(hall.run, 0);
  CHECK(hall.to_skip(100).empty());
}

TEST_CASE("what is late by an older view is so only if a new one shows it, too") {
  Hall hall;
  hall.t1().due = true;
  hall.task().start_within_s = 20;
  hall.task().on_failure = OnFailure::skip;
  hall.see(0);
  CHECK_FALSE(hall.overdue.wants_view(hall.run, hall.fleet, hall_time(24)));
  hall.run.view_as_of = hall_time(24).mono;
  CHECK(hall.overdue.wants_view(hall.run, hall.fleet, hall_time(25)));
  CHECK(hall.overdue.late(hall.run, hall.fleet).empty());
  CHECK(hall.overdue.to_skip(hall.run).empty());
  hall.run.view_as_of = hall_time(25).mono;
  CHECK_FALSE(hall.overdue.wants_view(hall.run, hall.fleet, hall_time(30)));
  CHECK(hall.overdue.late(hall.run, hall.fleet).size() == 1);
  CHECK(hall.overdue.to_skip(hall.run).size() == 1);
}

TEST_CASE("a task whose robot does another one is not late, however long that takes; then it gets its full time") {
  Hall hall;
  hall.t1().due = true;
  hall.run.view->tasks[1].state = TaskState::running;
  hall.task().timeout_s = 0;
  hall.see(0);
  CHECK_FALSE(hall.late(100));
  hall.run.view->tasks[1].state = TaskState::finished;
  hall.run.view->tasks[1].outcome = TaskOutcome::finished;
  hall.see(100);
  CHECK_FALSE(hall.late(129));
  CHECK(hall.late(130));
}

TEST_CASE("the same of a task of another run, which its robot's profile names; the run's own name says nothing") {
  Hall hall;
  hall.t1().due = true;
  NodeProfile profile = mobile_robot();
  profile.control = "run run2";
  REQUIRE(hall.fleet.on_route(route_of("r1", profile), at_second(1)));
  hall.see(0);
  CHECK_FALSE(hall.late(100));
  CHECK(hall.overdue.next(hall.run, hall.fleet, hall_time(100)) == hall_time(110).mono);
  for (const char* control : {"run run1", "cloud"}) {
    CAPTURE(control);
    Hall other;
    other.t1().due = true;
    profile.control = control;
    REQUIRE(other.fleet.on_route(route_of("r1", profile), at_second(2)));
    other.see(0);
    CHECK(other.late(30));
  }
}

TEST_CASE("a robot's word that it does a task of another run counts for ten minutes, unless that run shows it, too") {
  Hall hall;
  hall.t1().due = true;
  const auto say = [&](const char* control, int s) {
    NodeProfile profile = mobile_robot();
    profile.control = control;
    REQUIRE(hall.fleet.on_route(route_of("r1", profile), at_second(s)));
    hall.see(s);
  };
  say("run run2", 0);
  CHECK_FALSE(hall.late(599));
  SUBCASE("all the time") {
    hall.see(600);
    CHECK_FALSE(hall.late(629));
    CHECK(hall.late(630));
  }
  SUBCASE("again and again") {
    for (int s = 590; s < 620; s += 20) {
      say("", s);
      say("run run2", s + 10);
    }
    CHECK(hall.late(640));
  }
  SUBCASE("and the run shows it") {
    WatchedRun other = hall.run;
    other.summary.run = "run2";
    other.view->tasks[0].state = TaskState::running;
    hall.runs["run2"] = other;
    hall.see(10'000);
    CHECK_FALSE(hall.late(20'000));
    hall.runs["run2"].view->tasks[0].outcome = TaskOutcome::finished;
    hall.see(20'000);
    hall.see(20'601);
    CHECK(hall.late(20'631));
  }
}

TEST_CASE("a robot that is gone at another task does not keep the decider from skipping what did not begin in time") {
  Hall hall;
  hall.t1().due = true;
  hall.task().start_within_s = 20;
  hall.task().on_failure = OnFailure::skip;
  hall.run.view->tasks[1].state = TaskState::running;
  hall.see(0);
  CHECK(hall.late_at(25).empty());
  CHECK(hall.to_skip(25) == std::vector<std::size_t>{0});
}
