// Robots that were replaced and come back, in the orders of events that are easily overlooked.
#include <doctest/doctest.h>

#include "services/scheduler/test/decision_story.hpp"

using namespace trb;
using namespace trb::scheduler::test;

namespace {

struct ReplacedStory {
  explicit ReplacedStory(const std::vector<std::string>& robots, const std::function<void(Scenario&)>& change = {}) {
    add_demonstration(fleet);
    Scenario scenario = chain(robots);
    if (change) change(scenario);
    fleet.ask("cloud", MessageType::command, RunSubmit{start_without(fleet, scenario, {})});
  }
  TaskView task(std::size_t index, const std::string& node = "cloud") {
    return fleet.view(node, kStoryRun).tasks.at(index);
  }
  bool until(RunState state, Duration limit = seconds(120)) {
    return fleet.until([&] { return fleet.view("cloud", kStoryRun).state == state; }, limit);
  }
  /// What the cloud's scheduler answers: "accepted" or the Nack's code.
  std::string decide(std::vector<TaskRuling> rulings) {
    const std::size_t before = fleet.answers.size();
    fleet.ask("cloud", MessageType::command, RunDecision{decider.decision(std::move(rulings))});
    REQUIRE(fleet.answers.size() == before + 1);
    if (const auto* nack = get_if<Nack>(&fleet.answers.back())) return nack->code;
    return "accepted";
  }
  int begun(const std::string& robot, const std::string& task) {
    int out = 0;
    for (const auto& [key, times] : fleet[robot].adapter.begun) out += key.second.task == task ? times : 0;
    return out;
  }
  Fleet fleet;
  Decider decider{fleet, "", {}, ""};
};

TaskRuling move(const std::string& task, const std::string& robot, std::uint32_t attempt,
                Evidence evidence = Evidence::word) {
  return {task, Ruling::move, robot, attempt, evidence};
}

}  // namespace

TEST_CASE("a replaced robot that had tried again unheard stands down all the same") {
  ReplacedStory story({"ur3", "drone"}, [](Scenario& scenario) { scenario.tasks[0].retries = 4; });
  story.fleet["ur3"].adapter.endings = {{"task-0", TaskOutcome::failed}};
  REQUIRE(story.fleet.until([&] { return story.begun("ur3", "task-0") == 1; }));
  story.fleet["ur3"].cut = true;
  REQUIRE(story.fleet.until([&] { return story.begun("ur3", "task-0") == 3; }));
  story.fleet["ur3"].adapter.skill_time = seconds(30);
  REQUIRE(story.fleet.until([&] { return story.begun("ur3", "task-0") == 4; }));
  story.fleet["ur3"].adapter.endings.clear();
  story.fleet["pioneer"].adapter.skill_time = seconds(10);
  // As trb-resilience counts: one more than the last attempt that the cloud knows of.
  const std::string said = story.decide({move("task-0", "pioneer", 2)});
  if (said != "accepted") {
    CHECK(said == "conflict");
    REQUIRE(story.decide({move("task-0", "pioneer", 6)}) == "accepted");
  }
  story.fleet["ur3"].cut = false;
  REQUIRE(story.until(RunState::finished));
  CHECK(story.begun("ur3", "task-0") == 4);
  CHECK(story.begun("pioneer", "task-0") == 1);
  story.fleet.pass(seconds(60));
  CHECK(story.fleet.counted["double_execution"] == 0);
  CHECK(story.fleet.view("cloud", kStoryRun).state == RunState::finished);
}

TEST_CASE("a robot that is told to stop what was moved does not skip it for everybody") {
  ReplacedStory story({"ur3", "drone"}, [](Scenario& scenario) { scenario.tasks[0].on_failure = OnFailure::skip; });
  story.fleet["ur3"].adapter.skill_time = seconds(20);
  REQUIRE(story.fleet.until([&] { return story.task(0).state == TaskState::running; }));
  REQUIRE(story.decide({move("task-0", "pioneer", 2)}) == "accepted");
  REQUIRE(story.until(RunState::finished));
  CHECK(story.task(0).state == TaskState::finished);
  CHECK(story.task(1).state == TaskState::finished);
  CHECK(story.begun("drone", "task-1") == 1);
}

TEST_CASE("what is FINISHED already is not moved: the decider's scheduler says so") {
  ReplacedStory story({"ur3", "drone"});
  story.fleet["drone"].adapter.skill_time = seconds(60);
  REQUIRE(story.fleet.until([&] { return story.task(0).state == TaskState::finished; }));
  CHECK(story.decide({move("task-0", "pioneer", 2)}) == "conflict");
  story.fleet.pass(seconds(20));
  CHECK(story.begun("pioneer", "task-0") == 0);
  REQUIRE(story.until(RunState::finished));
}

TEST_CASE("without a person's word nothing leaves a robot that has not said that it stands") {
  ReplacedStory story({"ur3", "drone"});
  story.fleet["ur3"].adapter.skill_time = seconds(20);
  REQUIRE(story.fleet.until([&] { return story.task(0).state == TaskState::running; }));
  CHECK(story.decide({move("task-0", "pioneer", 2, Evidence::result)}) == "conflict");
  REQUIRE(story.until(RunState::finished));
  CHECK(story.begun("pioneer", "task-0") == 0);
}

TEST_CASE("a robot that the run has not reached yet gives its tasks back all the same") {
  ReplacedStory story({"ur3", "drone"});
  story.fleet["ur3"].adapter.skill_time = seconds(60);
  REQUIRE(story.fleet.until([&] { return story.task(0).state == TaskState::running; }));
  CHECK(story.fleet.view("drone", kStoryRun).run.empty());
  const auto tell = [&](const std::string& to, const std::string& from, MessageType type, Body body) {
    return story.fleet.tell(to, from, type, std::move(body), type == MessageType::information ? 1 : 0);
  };
  const ReleaseTasks order{kStoryRun, 1, {1}};
  Outbox out = tell("drone", "cloud", MessageType::command, order);
  REQUIRE(sent<NeedDefinition>(out).size() == 1);
  CHECK(sent<Nack>(out).empty());
  out = tell("cloud", "drone", MessageType::request, NeedDefinition{kStoryRun, {}});
  out = tell("drone", "cloud", MessageType::information, sent<Definition>(out).at(0));
  CHECK(sent<Ack>(out).size() == 1);
  REQUIRE(story.fleet.until([&] { return story.task(1).outcome == TaskOutcome::released; }, seconds(20)));
  REQUIRE(story.decide({move("task-1", "pioneer", 2, Evidence::result)}) == "accepted");
  REQUIRE(story.until(RunState::finished));
  CHECK(story.begun("drone", "task-1") == 0);
  CHECK(story.begun("pioneer", "task-1") == 1);
}

TEST_CASE("who replaces a robot that had finished after all is told before it begins") {
  ReplacedStory story({"ur3", "drone"});
  REQUIRE(story.fleet.until([&] { return story.task(0).state == TaskState::running; }));
  story.fleet["ur3"].cut = true;
  story.fleet["pioneer"].adapter.set(true, true);  // stopped until somebody releases it
  REQUIRE(story.decide({move("task-0", "pioneer", 2)}) == "accepted");
  story.fleet.pass(seconds(10));
  REQUIRE(story.begun("pioneer", "task-0") == 0);
  story.fleet["ur3"].cut = false;
  REQUIRE(story.fleet.until([&] { return story.task(0).state == TaskState::finished; }));
  story.fleet.pass(seconds(5));
  story.fleet["pioneer"].adapter.set(true, false);
  REQUIRE(story.until(RunState::finished));
  story.fleet.pass(seconds(10));
  CHECK(story.begun("pioneer", "task-0") == 0);
  CHECK(story.fleet.counted["double_execution"] == 0);
}

TEST_CASE(
    "a task is done twice, and the second robot hears of the first result while it works: the judge hears of both") {
  ReplacedStory story({"ur3", "drone", "pioneer"});
  REQUIRE(story.fleet.until([&] { return story.task(0).state == TaskState::running; }));
  story.fleet["ur3"].cut = true;
  story.fleet["pioneer"].adapter.skill_time = seconds(60);
  REQUIRE(story.decide({move("task-0", "pioneer", 2)}) == "accepted");
  REQUIRE(story.fleet.until([&] { return story.begun("pioneer", "task-0") == 1; }));
  story.fleet.pass(seconds(10));
  story.fleet["ur3"].cut = false;
  const auto is_told = [&] { return story.task(0, "pioneer").state == TaskState::finished; };
  REQUIRE(story.fleet.until(is_told, seconds(20)));
  REQUIRE(story.fleet.until([&] { return story.task(0).twice; }, seconds(100)));
  story.fleet.pass(seconds(60));
  CHECK(story.fleet.view("pioneer", kStoryRun).paused_by == "cloud");
  CHECK(story.begun("pioneer", "task-2") == 0);
  const std::uint32_t next = story.fleet.view("cloud", kStoryRun).pause_number + 1;
  const PauseOrder order{kStoryRun, next, false, "cloud", "looked at", 0, {"task-0"}};
  story.fleet.ask("cloud", MessageType::command, RunPause{story.fleet.sign("cloud", kSignedRunPause, encode(order))});
  CHECK(story.until(RunState::finished));
  CHECK(story.begun("pioneer", "task-2") == 1);
  story.fleet.pass(seconds(120));
  CHECK(story.fleet["pioneer"].archive->over(kStoryRun)->state == RunState::finished);
  const auto results = story.fleet["cloud"].archive->record(kStoryRun)->results;
  CHECK(results.size() == 4);
}

TEST_CASE("a robot dies between its result and the baton: whoever takes over its other tasks does not wait for it") {
  ReplacedStory story({"ur3", "drone", "ur3"});
  story.fleet["drone"].cut = true;  // the baton does not arrive
  REQUIRE(story.fleet.until([&] { return story.task(0).state == TaskState::finished; }));
  story.fleet["ur3"].cut = true;
  story.fleet["drone"].cut = false;
  REQUIRE(story.decide({move("task-2", "pioneer", 2)}) == "accepted");
  REQUIRE(story.until(RunState::finished));
}

TEST_CASE("a task that goes away and comes back is begun anew by its first robot") {
  ReplacedStory story({"ur3", "drone"});
  story.fleet["ur3"].adapter.skill_time = seconds(20);
  REQUIRE(story.fleet.until([&] { return story.task(0).state == TaskState::running; }));
  story.fleet["ur3"].cut = true;
  story.fleet["pioneer"].cut = true;
  REQUIRE(story.decide({move("task-0", "pioneer", 2)}) == "accepted");
  REQUIRE(story.decide({move("task-0", "ur3", 3)}) == "accepted");
  story.fleet["ur3"].adapter.skill_time = seconds(1);
  story.fleet["ur3"].cut = false;
  story.fleet["pioneer"].cut = false;
  REQUIRE(story.until(RunState::finished));
  CHECK(story.task(0).attempt == 3);
  CHECK(story.begun("pioneer", "task-0") == 0);
}

TEST_CASE("a robot dies for good between its result and the baton: the run names it, then the decider passes on") {
  ReplacedStory story({"ur3", "drone"});
  story.fleet["drone"].cut = true;
  REQUIRE(story.fleet.until([&] { return story.task(0).state == TaskState::finished; }));
  story.fleet["ur3"].cut = true;
  story.fleet["drone"].cut = false;
  story.fleet.pass(seconds(20));
  const RunView view = story.fleet.view("cloud", kStoryRun);
  CHECK(view.waits_for == "'drone' to begin task 'task-1', passed on by 'ur3'");
  story.fleet.stop("cloud");  // it forgets how long it has waited, no more
  story.fleet.start("cloud");
  REQUIRE(story.until(RunState::finished, seconds(60)));
  CHECK(story.fleet.view("cloud", kStoryRun).waits_for.empty());
  story.fleet["ur3"].cut = false;
  story.fleet.pass(seconds(60));
  CHECK(story.begun("drone", "task-1") == 1);
}

TEST_CASE("what was passed on and has not begun for long costs no second baton") {
  ReplacedStory story({"ur3", "drone"});
  story.fleet["drone"].adapter.set(true, true);  // stopped: it takes the baton, and begins nothing
  REQUIRE(story.fleet.until([&] { return story.task(0).state == TaskState::finished; }));
  story.fleet.pass(seconds(20));
  const int batons = story.fleet.carried["baton"];
  story.fleet.pass(seconds(200));
  CHECK(story.fleet.carried["baton"] == batons + 1);  // the decider's own, once: it cannot know of the other
  story.fleet["drone"].adapter.set(true, false);
  REQUIRE(story.until(RunState::finished));
}

TEST_CASE("the decider is gone before everybody has its decision: who is behind asks whoever refuses its baton") {
  ReplacedStory story({"ur3", "drone", "ur3"});
  story.fleet["ur3"].adapter.skill_time = seconds(10);
  REQUIRE(story.fleet.until([&] { return story.task(0).state == TaskState::running; }));
  story.fleet["ur3"].cut = true;
  REQUIRE(story.decide({move("task-2", "pioneer", 2)}) == "accepted");
  story.fleet.pass(seconds(3));
  story.fleet["cloud"].cut = true;
  story.fleet["ur3"].cut = false;
  const auto done = [&] { return story.begun("pioneer", "task-2") == 1; };
  REQUIRE(story.fleet.until(done, seconds(60)));
  CHECK(story.fleet.view("ur3", kStoryRun).epoch == 2);
  CHECK(story.begun("drone", "task-1") == 1);
}

TEST_CASE("decisions stay so small together that a member which comes late can be told of all") {
  ReplacedStory story(std::vector<std::string>(1000, "ur3"));
  story.fleet["ur3"].cut = true;
  std::string said;
  std::uint32_t attempt = 1;
  while (said.empty() || said == "accepted") {
    ++attempt;
    REQUIRE(attempt < scheduler::kMaxDecisions);
    std::vector<TaskRuling> rulings;
    for (int i = 1; i < 1000; ++i) {
      rulings.push_back(move("task-" + std::to_string(i), attempt % 2 == 0 ? "pioneer" : "ur3", attempt));
    }
    said = story.decide(std::move(rulings));
  }
  CHECK(said == "too_large");
  CHECK(attempt > 5);
  Outbox out = story.fleet.tell("cloud", "cloud", MessageType::request, NeedDefinition{kStoryRun, {}}, 0);
  CHECK(encode(sent<Definition>(out).at(0)).size() < kMaxDataSize);
}

TEST_CASE("a member for which the run is over is not told of its decisions and pauses for another day") {
  ReplacedStory story({"drone", "ur3"});
  story.fleet["ur3"].adapter.skill_time = seconds(20);
  REQUIRE(story.fleet.until([&] { return story.task(1).state == TaskState::running; }));
  story.fleet["drone"].cut = true;
  REQUIRE(story.decide({move("task-1", "pioneer", 2)}) == "accepted");
  const PauseOrder order{kStoryRun, 1, true, "cloud", "lunch", 0};
  story.fleet.ask("cloud", MessageType::command, RunPause{story.fleet.sign("cloud", kSignedRunPause, encode(order))});
  story.fleet.pass(seconds(3700));
  CHECK(story.fleet["drone"].archive->over(kStoryRun)->state == RunState::expired);
  CHECK_FALSE(story.fleet["cloud"].archive->over(kStoryRun));
  story.fleet["drone"].cut = false;
  story.fleet.pass(seconds(10));
  CHECK(story.fleet["cloud"].archive->over(kStoryRun)->state == RunState::expired);
}

TEST_CASE("whoever watches from elsewhere keeps no service of the own node from it") {
  scheduler::Watchers watchers;
  const Now now{{1'000'000'000}, {1'800'000'000'000'000'000}};
  const auto watch = [&](const std::string& source, std::uint64_t slot) {
    const Status added =
        watchers.add({MessageType::request, source, "cloud", slot << 48U, 0, 0, 1000, RunWatch{60}}, 60, now);
    return added ? "watches" : std::string(errc_name(added.error().code));
  };
  for (std::uint64_t slot = 1; slot <= scheduler::Watchers::kMax; ++slot) CHECK(watch("ur3", slot) == "watches");
  // Nor anybody else from its share.
  for (std::uint64_t slot = 1; slot <= 4; ++slot) CHECK(watch("drone", slot) == "watches");
  CHECK(watch("drone", 5) == "queue_full");
  CHECK(watch("cloud", 1) == "watches");
  CHECK(watch("ur3", 9) == "queue_full");
  for (std::uint64_t slot = 2; slot <= scheduler::Watchers::kMax; ++slot) CHECK(watch("cloud", slot) == "watches");
  CHECK(watch("cloud", 9) == "queue_full");
}
