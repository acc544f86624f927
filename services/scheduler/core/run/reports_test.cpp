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
