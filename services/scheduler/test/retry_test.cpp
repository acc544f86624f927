// What a robot does by itself when a task fails: tries again, skips it, ends the run.
#include <doctest/doctest.h>

#include "services/scheduler/test/decision_story.hpp"

using namespace trb;
using namespace trb::scheduler::test;

namespace {

struct Chain {
  explicit Chain(const std::function<void(Task&)>& change) {
    add_demonstration(fleet);
    Scenario scenario = chain({"ridgeback", "ur3", "drone"});
    change(scenario.tasks[1]);
    start = start_without(fleet, scenario, {});
    fleet["ur3"].adapter.endings = {{"task-1", TaskOutcome::failed}};
    fleet.ask("cloud", MessageType::command, RunSubmit{start});
  }
  bool until(RunState state, Duration limit = seconds(300)) {
    return fleet.until([&] { return fleet.view("cloud", kStoryRun).state == state; }, limit);
  }
  std::size_t attempts() {
    std::size_t out = 0;
    for (const auto& [key, times] : fleet["ur3"].adapter.begun) out += static_cast<std::size_t>(times);
    return out;
  }
  Fleet fleet;
  SignedRecord start;
};

}  // namespace

TEST_CASE("a task is tried again as often as it says, each time after twice as long; then it has failed") {
  Chain story([](Task& task) {
    task.retries = 3;
    task.retry_after_s = 2;
  });
  REQUIRE(story.until(RunState::paused));
  CHECK(story.attempts() == 4);
  CHECK(story.fleet.view("cloud", kStoryRun).tasks[1].state == TaskState::failed);
  CHECK(story.fleet.view("cloud", kStoryRun).tasks[1].attempt == 4);
  CHECK(to_seconds(story.fleet.now().mono - MonotonicTime{1'000'000'000}) > 2 + 4 + 8 + 4);
}

TEST_CASE("a mode-adapter that was started anew and does not say so is found out by the next question") {
  Chain story([](Task& task) { task.retries = 0; });
  FakeAdapter& adapter = story.fleet["ur3"].adapter;
  adapter.skill_time = seconds(60);
  REQUIRE(story.fleet.until([&] { return story.attempts() == 1; }));
  story.fleet.pass(seconds(1));
  adapter.restart();
  adapter.take();
  REQUIRE(story.until(RunState::paused, seconds(20)));
  CHECK(story.fleet.view("cloud", kStoryRun).tasks[1].outcome == TaskOutcome::interrupted);
  CHECK(adapter.halted.size() == 1);  // the robot still did what the earlier process had given it
}

TEST_CASE("a robot that has told an outcome is free for its next task, without being asked") {
  Fleet fleet;
  add_demonstration(fleet);
  fleet["ur3"].adapter.tells_free = false;
  fleet.pass(seconds(5));
  const int asked = fleet["ur3"].adapter.asked_state;
  fleet.ask("cloud", MessageType::command, RunSubmit{start_without(fleet, chain({"ur3", "ur3", "ur3"}), {})});
  REQUIRE(fleet.until([&] { return fleet.view("cloud", kStoryRun).state == RunState::finished; }));
  CHECK(fleet["ur3"].adapter.asked_state == asked);
}

TEST_CASE("the cloud shows a task that is given to its robot before the robot says that it has begun") {
  Chain story([](Task& task) { task.retries = 0; });
  REQUIRE(story.fleet.until(
      [&] { return story.fleet.view("cloud", kStoryRun).tasks[1].state == TaskState::initializing; }));
  CHECK(story.until(RunState::paused));
}

TEST_CASE(
    "a task that succeeds when it is tried again goes on as if nothing had been; a restart between does no harm") {
  for (const bool restarts : {false, true}) {
    CAPTURE(restarts);
    Chain story([](Task& task) { task.retries = 5; });
    REQUIRE(story.fleet.until([&] { return story.attempts() == 2; }));
    story.fleet["ur3"].adapter.endings.clear();
    if (restarts) {
      story.fleet.stop("ur3");
      story.fleet.pass(seconds(3));
      story.fleet.start("ur3");
    }
    REQUIRE(story.until(RunState::finished));
    CHECK(story.fleet.view("cloud", kStoryRun).waits_for.empty());
    for (const auto& [key, times] : story.fleet["ur3"].adapter.begun) CHECK(times == 1);
  }
}

TEST_CASE("a failure that skips: the task is SKIPPED with the robot's words, and nobody has to decide") {
  Chain story([](Task& task) { task.on_failure = OnFailure::skip; });
  REQUIRE(story.until(RunState::finished));
  const RunView view = story.fleet.view("cloud", kStoryRun);
  CHECK(view.tasks[1].state == TaskState::skipped);
  CHECK(view.tasks[1].reason == "failed, which skips it: the gripper is stuck");
  CHECK(view.tasks[2].state == TaskState::skipped);
}

TEST_CASE("a failure that aborts: the robot's own node orders it, and every member confirms") {
  Chain story([](Task& task) { task.on_failure = OnFailure::abort; });
  REQUIRE(story.fleet.until([&] { return story.fleet.view("ur3", kStoryRun).state == RunState::aborted; }));
  REQUIRE(story.until(RunState::aborted));
  CHECK(story.fleet.carried["run_abort"] >= 2);
}

TEST_CASE("an interrupted task is not tried again by itself, whatever it says") {
  Chain story([](Task& task) { task.retries = 3; });
  REQUIRE(story.fleet.until([&] { return story.attempts() == 1; }));
  story.fleet["ur3"].adapter.restart();
  REQUIRE(story.until(RunState::paused));
  CHECK(story.fleet.view("cloud", kStoryRun).tasks[1].outcome == TaskOutcome::interrupted);
  CHECK(story.attempts() == 1);
}

TEST_CASE("a value of an earlier result goes into the command; one that is not there fails the task unbegun") {
  for (const bool there : {true, false}) {
    CAPTURE(there);
    Chain story([&](Task& task) { task.values = {{"done", "task-0", there ? "done" : "missing"}}; });
    story.fleet["ur3"].adapter.endings.clear();
    REQUIRE(story.until(there ? RunState::finished : RunState::paused));
    CHECK(story.attempts() == (there ? 1 : 0));
    if (!there) CHECK(story.fleet.view("cloud", kStoryRun).waits_for.find("missing") != std::string::npos);
  }
}
