#include "services/cli/core/task_words.hpp"

#include <doctest/doctest.h>

using namespace trb;
using namespace trb::cli;

namespace {

TaskResult done_by(const std::string& robot, std::uint32_t attempt, std::int64_t began) {
  TaskResult out;
  out.key.attempt = attempt;
  out.robot = robot;
  out.outcome = TaskOutcome::finished;
  out.started = began;
  out.ended = began + 1;
  out.duration_s = 9.32;
  return out;
}

}  // namespace

TEST_CASE("a task that nobody tries again by itself is not called so") {
  TaskView task;
  task.state = TaskState::retriable;
  CHECK(state_word(task) == "NOT DONE");
  task.outcome = TaskOutcome::interrupted;
  CHECK(state_word(task) == "INTERRUPTED");
  task.state = TaskState::finished;
  CHECK(state_word(task) == "FINISHED");
}

TEST_CASE("of a task that was done twice the doer of the attempt that is shown is named, and the other one") {
  TaskView task;
  task.robot = "turtlebot";
  task.moved_from = "pioneer1";
  task.attempt = 1;
  task.started = 5;
  task.ended = 6;
  task.twice = true;
  const std::vector<TaskResult> doers{done_by("pioneer1", 1, 5), done_by("turtlebot", 2, 1'000'000'000)};
  CHECK(robot_of(task, doers) == "pioneer1");
  CHECK(why_of(task, doers) ==
        "done twice, also by turtlebot: attempt 2, began 1970-01-01T00:00:01.000Z, took 9.32 s; was pioneer1's");
  CHECK(robot_of(task, {}) == "turtlebot");
  CHECK(why_of(task, {}) == "done twice; was pioneer1's");
  CHECK(robot_of({}, {}) == "-");
}

TEST_CASE("a task that was moved and done once is of its doer") {
  TaskView task;
  task.robot = "turtlebot";
  task.attempt = 2;
  task.started = 5;
  task.ended = 6;
  CHECK(robot_of(task, {done_by("turtlebot", 2, 5)}) == "turtlebot");
  CHECK(why_of(task, {done_by("turtlebot", 2, 5)}).empty());
}
