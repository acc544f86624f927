#include "services/scheduler/core/run/reports.hpp"

#include <doctest/doctest.h>

using namespace trb;
using namespace trb::scheduler;

TEST_CASE("what batons say is added up; only what is final can be SKIPPED") {
  Reports reports(3);
  reports.add({true, false, false}, {false, true, false});
  reports.add({false, false, true}, {false, false, true});
  CHECK(reports.final_tasks() == std::vector<bool>{true, false, true});
  CHECK(reports.skipped_tasks() == std::vector<bool>{false, false, true});
}

TEST_CASE("a baton that is repeated says nothing new") {
  Reports reports(2);
  CHECK_FALSE(reports.add({false, false}, {true, true}));
  CHECK(reports.add({true, false}, {false, false}));
  CHECK_FALSE(reports.add({true, false}, {false, true}));
  CHECK(reports.add({true, false}, {true, false}));
  CHECK_FALSE(reports.add({true, false}, {false, false}));
}

TEST_CASE("a task is under way from its robot's word on, and its condition waits no more") {
  Reports reports(2);
  reports.note_wait(1, "the sensor cannot be reached");
  CHECK(reports.first_wait() == "the sensor cannot be reached");
  reports.note_progress(1, TaskState::running);
  CHECK(reports.is_under_way(1));
  CHECK(reports.progress_of(1) == TaskState::running);
  CHECK(reports.first_wait().empty());
  reports.forget_progress(1);
  CHECK_FALSE(reports.progress_of(1).has_value());
}

TEST_CASE("what an attempt waits for is forgotten when it begins, and when it is over") {
  Reports reports(2);
  reports.note_progress(1, TaskState::initializing, "its gripper is out of use");
  CHECK(reports.is_under_way(1));
  CHECK(reports.first_wait() == "its gripper is out of use");
  reports.note_progress(1, TaskState::running);
  CHECK(reports.first_wait().empty());
  reports.note_progress(1, TaskState::initializing, "the robot is OFFLINE");
  reports.forget_progress(1);
  CHECK(reports.first_wait().empty());
}

TEST_CASE("what a condition waits for is not forgotten with an attempt that nobody has reported") {
  Reports reports(2);
  reports.note_wait(1, "the sensor cannot be reached");
  reports.forget_progress(1);
  CHECK(reports.first_wait() == "the sensor cannot be reached");
}

TEST_CASE("what is shown changes with a state or with what is waited for, not if the same is reported again") {
  Reports reports(2);
  const auto changes_of = [&](const auto& report) {
    const std::uint64_t before = reports.changes();
    report();
    return reports.changes() - before;
  };
  CHECK(changes_of([&] { reports.note_wait(1, "the sensor cannot be reached"); }) == 1);
  CHECK(changes_of([&] { reports.note_wait(1, "the sensor cannot be reached"); }) == 0);
  CHECK(changes_of([&] { reports.note_progress(1, TaskState::initializing, "the robot is OFFLINE"); }) > 0);
  CHECK(changes_of([&] { reports.note_progress(1, TaskState::initializing, "the robot is OFFLINE"); }) == 0);
  CHECK(changes_of([&] { reports.note_progress(1, TaskState::initializing); }) == 1);
  CHECK(changes_of([&] { reports.note_progress(1, TaskState::running); }) == 1);
  CHECK(changes_of([&] { reports.note_progress(1, TaskState::running); }) == 0);
}

TEST_CASE("a robot that reports one state after the other soon changes nothing that watchers are told of") {
  Reports reports(2);
  const auto flicker = [&](TaskIndex task) {
    for (int i = 0; i < 1000; ++i) {
      reports.note_progress(task, TaskState::paused);
      reports.note_progress(task, TaskState::running);
    }
  };
  flicker(0);
  CHECK(reports.changes() == Reports::kMostChanges);
  CHECK(reports.progress_of(0) == TaskState::running);
  flicker(1);  // the other task has its own
  CHECK(reports.changes() == 2 * Reports::kMostChanges);
  reports.forget_progress(0);
  reports.note_progress(0, TaskState::running);  // another attempt
  CHECK(reports.changes() == 2 * Reports::kMostChanges + 1);
}
