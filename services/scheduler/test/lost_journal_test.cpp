// A robot's node whose journal was lost, and whose robot a person has looked at: what it has done is not done again,
// and all else goes on.
#include <doctest/doctest.h>

#include "common/scenario/run_start.hpp"
#include "common/scenario/test/make_task.hpp"
#include "services/scheduler/test/decision_story.hpp"

using namespace trb;
using namespace trb::scheduler;
using namespace trb::scheduler::test;

namespace {

Task lost_task(const char* id, const char* robot, std::vector<TaskIndex> after) {
  return make_task(id, robot, id, std::move(after));
}

/// The UR's node loses its journal while the drone flies.
struct LossStory {
  explicit LossStory(const std::vector<const char*>& robots = {"drone", "ur3"}, const std::string& from = "cloud")
      : submitter(from) {
    if (submitter == "cloud") fleet.add("cloud", Role::cloud);
    for (const char* robot : robots) fleet.add(robot, Role::robot);
    adapter("drone").skill_time = seconds(20);
  }
  void submit(std::vector<Task> tasks) {
    const SignedRecord start = fleet.make_start({"loss", "", std::move(tasks)}, submitter, seconds(3600), kStoryRun);
    fleet.ask(submitter, MessageType::command, RunSubmit{start});
  }
  void lose_journal() {
    fleet.stop("ur3");
    fleet["ur3"].journal = {JournalLost{fleet.now().utc.ns, true}};
    adapter("ur3").restart();
    fleet.start("ur3");
  }
  void retry(const char* task, std::uint32_t attempt) {
    const Decider decider(fleet, "", {}, "");
    const SignedRecord decision = decider.decision({{task, Ruling::retry, "ur3", attempt, Evidence::word}});
    fleet.ask("cloud", MessageType::command, RunDecision{decision});
  }
  FakeAdapter& adapter(const std::string& robot) { return fleet[robot].adapter; }
  std::size_t begun() { return adapter("ur3").begun.size(); }
  bool begins(std::size_t count) {
    return fleet.until([&] { return begun() >= count; }, seconds(120));
  }
  bool knows_run() {
    return fleet.until([&] { return fleet.view("ur3", kStoryRun).run == kStoryRun; }, seconds(60));
  }
  TaskOutcome outcome(std::size_t task) { return fleet.view(submitter, kStoryRun).tasks.at(task).outcome; }
  bool ends(RunState state = RunState::finished) {
    return fleet.until([&] { return fleet.view(submitter, kStoryRun).state == state; }, seconds(300));
  }
  std::string submitter;
  Fleet fleet;
};

}  // namespace

TEST_CASE("what was done in an epoch that is not known here any more is not done again") {
  LossStory story;
  story.adapter("ur3").endings["grip"] = TaskOutcome::failed;
  story.submit({lost_task("grip", "ur3", {}), lost_task("fly", "drone", {}), lost_task("pack", "ur3", {1})});
  REQUIRE(story.ends(RunState::paused));
  story.fleet["drone"].cut = true;
  story.adapter("ur3").endings.clear();
  story.retry("grip", 2);
  REQUIRE(story.fleet.until([&] { return story.outcome(0) == TaskOutcome::finished; }, seconds(60)));
  story.fleet.pass(seconds(30));
  // The drone, still in epoch 1, passes its baton on; the cloud's node comes back after that.
  story.fleet.stop("cloud");
  story.lose_journal();
  story.fleet["drone"].cut = false;
  REQUIRE(story.knows_run());
  story.fleet.pass(seconds(1));
  story.fleet["drone"].cut = true;
  story.fleet.start("cloud");
  REQUIRE(story.begins(3));
  CHECK(story.fleet.view("ur3", kStoryRun).epoch == 2);
  story.fleet["drone"].cut = false;
  REQUIRE(story.ends());
  CHECK(story.begun() == 3);
}

TEST_CASE("a task that has failed keeps no other from beginning, and may be repeated itself") {
  LossStory story;
  story.adapter("ur3").endings["grip"] = TaskOutcome::failed;
  story.submit({lost_task("grip", "ur3", {}), lost_task("fly", "drone", {}), lost_task("pack", "ur3", {1})});
  REQUIRE(story.ends(RunState::paused));
  story.lose_journal();
  REQUIRE(story.begins(2));
  story.adapter("ur3").endings.clear();
  story.retry("grip", 2);
  REQUIRE(story.ends());
  CHECK(story.begun() == 3);
}

TEST_CASE("of a run without a cloud its submitter is asked") {
  LossStory story({"drone", "ur3"}, "drone");
  story.submit({lost_task("grip", "ur3", {}), lost_task("fly", "drone", {0}), lost_task("pack", "ur3", {1})});
  REQUIRE(story.fleet.until([&] { return story.adapter("drone").begun.size() == 1; }));
  story.lose_journal();
  REQUIRE(story.ends());
  CHECK(story.begun() == 2);
}
