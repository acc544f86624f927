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

TEST_CASE("a task that its robot will try again is not due meanwhile, and says when that is; so after a restart, too") {
  for (const bool restarts : {false, true}) {
    CAPTURE(restarts);
    Chain story([](Task& task) {
      task.retries = 1;
      task.retry_after_s = 50;
      task.start_within_s = 3;  // from the end of the pause on
    });
    const auto shown = [&](const char* node = "cloud") { return story.fleet.view(node, kStoryRun).tasks[1]; };
    REQUIRE(story.fleet.until([&] { return shown().attempt == 2; }));
    if (restarts) {
      story.fleet.stop("cloud");
      story.fleet.pass(seconds(2));
      story.fleet.start("cloud");
    }
    story.fleet.pass(seconds(40));
    for (const char* node : {"cloud", "ur3"}) {
      CAPTURE(node);
      CHECK_FALSE(shown(node).due);
      CHECK(shown(node).waits_for.starts_with("'ur3' to try task 'task-1' again, at "));
    }
    CHECK(story.fleet.view("cloud", kStoryRun).waits_for == shown().waits_for);
    CHECK(story.attempts() == 1);
    story.fleet["ur3"].adapter.endings.clear();
    REQUIRE(story.until(RunState::finished, seconds(20)));
    CHECK(story.attempts() == 2);
  }
}

TEST_CASE("a cloud that was cut off during a failure says nothing of another try once the task is FINISHED") {
  Chain story([](Task& task) {
    task.retries = 2;
    task.retry_after_s = 100;
  });
  const auto view = [&] { return story.fleet.view("cloud", kStoryRun); };
  story.fleet["drone"].adapter.skill_time = seconds(300);
  REQUIRE(story.fleet.until([&] { return story.attempts() == 1; }));
  story.fleet["cloud"].cut = true;
  story.fleet.pass(seconds(90));
  story.fleet["cloud"].cut = false;
  story.fleet["ur3"].adapter.endings.clear();
  REQUIRE(story.fleet.until([&] { return view().tasks[1].state == TaskState::finished; }, seconds(60)));
  story.fleet.pass(seconds(5));
  CHECK(view().tasks[1].waits_for.empty());
  CHECK(view().waits_for.empty());
}

TEST_CASE("an aborted run tries nothing again, and its record says nothing of it") {
  Chain story([](Task& task) {
    task.retries = 2;
    task.retry_after_s = 300;
  });
  const auto waits = [&](const char* node) { return story.fleet.view(node, kStoryRun).tasks[1].waits_for; };
  REQUIRE(story.fleet.until([&] { return story.fleet.view("cloud", kStoryRun).tasks[1].attempt == 2; }));
  CHECK(waits("cloud").find("again") != std::string::npos);
  story.fleet.ask("cloud", MessageType::command, RunAbort{story.fleet.sign_order("cloud", kStoryRun)});
  REQUIRE(story.until(RunState::aborted));
  CHECK(waits("cloud").empty());
  CHECK(waits("ur3").empty());
  story.fleet.pass(seconds(100));  // it is in the archive
  CHECK(waits("cloud").empty());
}

TEST_CASE("who replaced a robot does not wait for the pause after that one's failure: its task is due") {
  Chain story([](Task& task) {
    task.retries = 2;
    task.retry_after_s = 600;
  });
  const auto task = [&](const char* node) { return story.fleet.view(node, kStoryRun).tasks[1]; };
  story.fleet["ur3"].adapter.skill_time = seconds(5);
  REQUIRE(story.fleet.until([&] { return task("cloud").state == TaskState::running; }));
  story.fleet["ur3"].cut = true;
  story.fleet.pass(seconds(10));
  REQUIRE(task("ur3").attempt == 2);
  const Decider decider(story.fleet, "", {}, "");
  story.fleet["pioneer"].adapter.set(false, false);
  story.fleet.ask("cloud", MessageType::command,
                  RunDecision{decider.decision({{"task-1", Ruling::move, "pioneer", 5, Evidence::word}})});
  story.fleet.pass(seconds(3));
  REQUIRE(task("cloud").robot == "pioneer");
  story.fleet["ur3"].cut = false;
  story.fleet.pass(seconds(15));
  CHECK(task("cloud").due);
  CHECK(task("cloud").waits_for.find("again") == std::string::npos);
}

TEST_CASE("a task that waits for another one of its robot says so where the run is decided, and in another run, too") {
  Fleet fleet;
  add_demonstration(fleet);
  fleet["ur3"].adapter.skill_time = seconds(40);
  Scenario both = chain({"ur3", "ur3"});
  both.tasks[1].after.clear();
  fleet.ask("cloud", MessageType::command, RunSubmit{start_without(fleet, both, {})});
  fleet.pass(seconds(1));
  const std::string other = "00000000000000000000000000000002";
  fleet.ask("cloud", MessageType::command, RunSubmit{fleet.make_start(chain({"ur3"}), "cloud", seconds(3600), other)});
  fleet.pass(seconds(20));
  const std::string wait = "task 'task-0' of run " + kStoryRun + " to end on 'ur3'";
  for (const char* node : {"cloud", "ur3"}) {
    CAPTURE(node);
    CHECK(fleet.view(node, kStoryRun).tasks[1].waits_for == wait);
    CHECK(fleet.view(node, other).tasks[0].waits_for == wait);
    CHECK(fleet.view(node, other).waits_for == wait);
  }
}

TEST_CASE("a task that does not begin in time has failed, also while its robot is at another task") {
  for (const OnFailure then : {OnFailure::abort, OnFailure::skip, OnFailure::continue_, OnFailure::resilience}) {
    for (const bool other_run : {false, true}) {
      CAPTURE(other_run);
      CAPTURE(static_cast<int>(then));
      Fleet fleet;
      add_demonstration(fleet);
      fleet["ur3"].adapter.skill_time = seconds(30);
      Scenario both = chain({"ur3", "ur3"});
      both.tasks[1].after.clear();
      if (other_run) {
        const std::string other = "00000000000000000000000000000002";
        fleet.ask("cloud", MessageType::command,
                  RunSubmit{fleet.make_start(chain({"ur3"}), "cloud", seconds(3600), other)});
        fleet.pass(seconds(3));
        both.tasks.erase(both.tasks.begin());
      }
      Task& late = both.tasks.back();
      late.start_within_s = 5;
      late.on_failure = then;
      fleet.ask("cloud", MessageType::command, RunSubmit{start_without(fleet, both, {})});
      fleet.pass(seconds(10));
      const RunView view = fleet.view("cloud", kStoryRun);
      const TaskView& shown = view.tasks.back();
      CHECK(shown.reason.find("did not begin within 5 s: the robot was at task 'task-0' of run ") != std::string::npos);
      const bool skips = then == OnFailure::skip || then == OnFailure::continue_;
      CHECK(shown.outcome == (skips ? TaskOutcome::skipped : TaskOutcome::failed));
      fleet.pass(seconds(30));
      const std::size_t begun = fleet["ur3"].adapter.begun.size();
      CHECK(begun == 1);
      const RunState ends = skips                           ? RunState::finished
                            : then == OnFailure::resilience ? RunState::paused
                                                            : RunState::aborted;
      CHECK(fleet.view("cloud", kStoryRun).state == ends);
    }
  }
}
