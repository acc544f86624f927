// Tasks that name no robot: the decider's node holds them, says when they are due, and a decision gives them to a
// robot.
#include "services/scheduler/test/condition_story.hpp"
#include "services/scheduler/test/crashes.hpp"
#include "services/scheduler/test/decision_story.hpp"

#include "common/scenario/run_start.hpp"

using namespace trb;
using namespace trb::scheduler::test;

namespace {

Task anybodys(const char* id, std::vector<TaskIndex> after) {
  Task out = task(id, "", std::move(after));
  out.requires_ = {"mobile"};
  return out;
}

/// `carry` is whoever's can, between what the ridgeback does and what the UR does; beside it the drone flies.
Scenario whoever_can() {
  Scenario scenario;
  scenario.name = "whoever can";
  scenario.tasks = {task("bring", "ridgeback", {}), anybodys("carry", {0}), task("fly", "drone", {0}),
                    task("grab", "ur3", {1, 2})};
  return scenario;
}

using Takers = std::map<std::string, std::string>;

/// The story, and what trb-resilience does on the cloud's node in a few lines: who takes which task is given.
struct Late : Story {
  explicit Late(Takers given, std::uint64_t seed = 1) : Story(seed), takers(std::move(given)) {}

  SignedRecord start(Scenario scenario, const std::string& node = "cloud") const {
    std::vector<std::string> robots;
    for (const Task& one : scenario.tasks) robots.push_back(one.robot.empty() ? "cloud" : one.robot);
    const UtcTime now = fleet.now().utc;
    return fleet.sign(node, kSignedRunStart,
                      encode(build_run_start(std::move(scenario), fleet.members(), node, now, now + seconds(3600), kRun,
                                             std::move(robots))));
  }
  void submit(const Scenario& scenario, const std::string& node = "cloud") {
    fleet.ask(node, MessageType::command, RunSubmit{start(scenario, node)});
  }
  /// Gives the first task that waits for a robot to its taker, and says it again until the run shows it.
  void choose() {
    if (!fleet["cloud"].up || fleet.now().mono < next) return;
    for (const TaskView& one : view().tasks) {
      const bool wanted = one.robot.empty() && one.outcome == TaskOutcome::released;
      if (!wanted || !takers.contains(one.id)) continue;
      if (!decided.contains(one.id)) {
        const Ruling ruling = takers[one.id] == "cloud" ? Ruling::skip : Ruling::move;
        decided[one.id] = decider.decision({{one.id, ruling, takers[one.id], 2, Evidence::result}});
      }
      next = fleet.now().mono + seconds(1);
      return fleet.ask("cloud", MessageType::command, RunDecision{decided[one.id]});
    }
  }
  bool ends(RunState state = RunState::finished) {
    const auto done = [&] {
      choose();
      if (!fleet["cloud"].up) return false;
      const RunState now = view().state;
      seen_states.insert(now);
      return now == state;
    };
    for (int i = 0; i < 600; ++i) {
      if (fleet.until(done, seconds(1))) return true;
      fleet.pass(seconds(0.1));
    }
    return false;
  }
  void check_each_once() {
    for (const auto& one : begun()) CHECK_MESSAGE(one.second == 1, one.first);
    CHECK(fleet.counted["double_execution"] == 0);
  }
  int begun_by(const std::string& robot) { return static_cast<int>(fleet[robot].adapter.begun.size()); }

  Takers takers;
  Decider decider{fleet, "", {}, ""};
  std::map<std::string, SignedRecord> decided;
  std::set<RunState> seen_states;
  MonotonicTime next{};
};

}  // namespace

TEST_CASE("a task that names no robot gets one by a decision once it is due, and the run was RUNNING all the time") {
  Late story(Takers{{"carry", "pioneer"}});
  story.submit(whoever_can());
  CHECK(story.seen("carry").robot.empty());
  REQUIRE(story.fleet.until([&] { return story.seen("bring").state == TaskState::running; }));
  CHECK(story.seen("carry").outcome == TaskOutcome::none);
  REQUIRE(story.ends());
  story.check_each_once();
  CHECK(story.begun_by("pioneer") == 1);
  CHECK(story.seen_states == std::set<RunState>{RunState::running, RunState::finished});
  const RunView view = story.view();
  CHECK(view.epoch == 2);
  REQUIRE(view.decisions.size() == 1);
  CHECK(view.decisions[0].tasks[0].robot == "pioneer");
  CHECK(story.seen("carry").robot == "pioneer");
  CHECK(story.seen("carry").moved_from.empty());
  CHECK(story.seen("carry", "ur3").robot == "pioneer");
}

TEST_CASE("the first task, of a run that a robot's node has begun, and several at once") {
  Scenario scenario;
  scenario.name = "all late";
  scenario.tasks = {anybodys("a", {}), anybodys("b", {}), anybodys("c", {0, 1})};
  Late story(Takers{{"a", "pioneer"}, {"b", "ridgeback"}, {"c", "pioneer"}});
  story.submit(scenario, "ur3");
  REQUIRE(story.ends());
  story.check_each_once();
  CHECK(story.view().epoch == 4);
  CHECK(story.begun_by("pioneer") == 2);
  CHECK(story.begun_by("ridgeback") == 1);
}

TEST_CASE("nobody can do it: the run is PAUSED and says what for, the others go on; later somebody comes") {
  Late story(Takers{});
  story.submit(whoever_can());
  REQUIRE(story.fleet.until([&] { return !story.view().waits_for.empty(); }));
  CHECK(story.view().state == RunState::running);
  CHECK(story.view().waits_for == "a robot for task 'carry', to be chosen by 'cloud'; see: trb alert list");
  story.fleet.pass(seconds(11));
  CHECK(story.view().state == RunState::paused);
  CHECK(story.view().waits_for == "a robot for task 'carry', to be chosen by 'cloud'; see: trb alert list");
  CHECK(story.seen("fly").state == TaskState::finished);
  story.takers = {{"carry", "ridgeback"}};
  REQUIRE(story.ends());
  story.check_each_once();
  CHECK(story.begun_by("ridgeback") == 2);
}

TEST_CASE(
    "nobody can do it in the time in which it was to begin: it has failed, and the run goes on as its author says") {
  for (const OnFailure then : {OnFailure::skip, OnFailure::continue_, OnFailure::abort, OnFailure::resilience}) {
    CAPTURE(static_cast<int>(then));
    Late story(Takers{});
    Scenario scenario = whoever_can();
    scenario.tasks[1].start_within_s = 12;
    scenario.tasks[1].on_failure = then;
    story.submit(scenario);
    REQUIRE(story.fleet.until([&] { return story.seen("carry").outcome == TaskOutcome::released; }));
    story.fleet.pass(seconds(10));
    CHECK(story.seen("carry").outcome == TaskOutcome::released);
    CHECK(story.begun_by("ur3") == 0);
    story.fleet.pass(seconds(30));
    if (then == OnFailure::resilience) {  // people are asked all the time
      CHECK(story.view().state == RunState::paused);
      CHECK(story.seen("carry").outcome == TaskOutcome::released);
      continue;
    }
    if (then == OnFailure::abort) {
      CHECK(story.view().state == RunState::aborted);
      continue;
    }
    CHECK(story.view().state == RunState::finished);
    CHECK(story.seen("carry", "ur3").outcome == TaskOutcome::skipped);
    CHECK(story.seen("carry").reason == "it did not begin within 12 s: no robot was chosen");
    CHECK(story.begun_by("ur3") == 1);
  }
}

TEST_CASE("a run that was held gives a task that wants a robot its time anew") {
  Late story(Takers{});
  Scenario scenario = whoever_can();
  scenario.tasks[1].start_within_s = 12;
  scenario.tasks[1].on_failure = OnFailure::skip;
  story.submit(scenario);
  REQUIRE(story.fleet.until([&] { return story.seen("carry").outcome == TaskOutcome::released; }));
  const auto order = [&](std::uint32_t number, bool paused) {
    PauseOrder is{kRun, number, paused, "cloud", "lunch", story.fleet.now().utc.ns, {}};
    story.fleet.ask("cloud", MessageType::command, RunPause{story.fleet.sign("cloud", kSignedRunPause, encode(is))});
  };
  order(1, true);
  story.fleet.pass(seconds(30));
  CHECK(story.seen("carry").outcome == TaskOutcome::released);
  order(2, false);
  story.fleet.pass(seconds(10));
  CHECK(story.seen("carry").outcome == TaskOutcome::released);
  story.fleet.pass(seconds(5));
  CHECK(story.seen("carry").outcome == TaskOutcome::skipped);
}

TEST_CASE("a clock that steps changes nothing of the time that a task without a robot has") {
  for (const double ahead_s : {-3600.0, -60.0, 3600.0}) {
    CAPTURE(ahead_s);
    for (const OnFailure then : {OnFailure::skip, OnFailure::abort}) {
      Late story(Takers{});
      Scenario scenario = whoever_can();
      scenario.tasks[1].start_within_s = 12;
      scenario.tasks[1].on_failure = then;
      story.submit(scenario);
      story.fleet.pass(seconds(0.2));
      REQUIRE(story.seen("carry").outcome == TaskOutcome::none);
      story.fleet["cloud"].clock.set({.ahead_s = ahead_s});
      REQUIRE(story.fleet.until([&] { return story.seen("carry").outcome != TaskOutcome::none; }, seconds(20)));
      story.fleet.pass(seconds(3));
      CHECK(story.seen("carry").outcome == TaskOutcome::released);
      CHECK(story.view().state == RunState::running);
      story.fleet.pass(seconds(30));
      if (then == OnFailure::abort) {
        CHECK(story.view().state == RunState::aborted);
      } else {
        CHECK(story.seen("carry").outcome == TaskOutcome::skipped);
      }
    }
  }
}

TEST_CASE("whoever lets a run go on, the time that its order states changes nothing of the time that a task has") {
  constexpr std::int64_t kHour = 3'600'000'000'000;
  for (const std::int64_t off : {std::int64_t{0}, -kHour, kHour, std::numeric_limits<std::int64_t>::max()}) {
    CAPTURE(off);
    Late story(Takers{});
    Scenario scenario = whoever_can();
    scenario.tasks[1].start_within_s = 12;
    scenario.tasks[1].on_failure = OnFailure::skip;
    story.submit(scenario);
    REQUIRE(story.fleet.until([&] { return story.seen("carry").outcome == TaskOutcome::released; }));
    const auto order = [&](std::uint32_t number, bool paused) {
      const bool forged = off == std::numeric_limits<std::int64_t>::max();
      const std::int64_t time = forged ? off : story.fleet.now().utc.ns + off;
      const PauseOrder is{kRun, number, paused, "ridgeback", "lunch", time, {}};
      story.fleet.ask("ridgeback", MessageType::command,
                      RunPause{story.fleet.sign("ridgeback", kSignedRunPause, encode(is))});
    };
    order(1, true);
    story.fleet.pass(seconds(60));
    CHECK(story.view().paused_by == "ridgeback");
    order(2, false);
    story.fleet.pass(seconds(10));
    CHECK(story.seen("carry").outcome == TaskOutcome::released);
    story.fleet.pass(seconds(20));
    CHECK(story.seen("carry").outcome == TaskOutcome::skipped);
  }
}

TEST_CASE("who was chosen fails: its task goes on to another one, as any other") {
  Late story(Takers{{"carry", "pioneer"}});
  story.fleet["pioneer"].adapter.endings = {{"carry", TaskOutcome::failed}};
  story.submit(whoever_can());
  REQUIRE(story.ends(RunState::paused));
  CHECK(story.seen("carry").robot == "pioneer");
  CHECK(story.view().waits_for == "task 'carry' failed on 'pioneer': the gripper is stuck");
  story.fleet.ask("cloud", MessageType::command,
                  RunDecision{story.decider.decision({{"carry", Ruling::move, "conveyor", 3, Evidence::result}})});
  REQUIRE(story.ends());
  CHECK(story.seen("carry").robot == "conveyor");
  CHECK(story.seen("carry").moved_from == "pioneer");
}

TEST_CASE("what is skipped needs no robot: by its condition, behind what was skipped, or by a decision") {
  for (const bool decided : {false, true}) {
    CAPTURE(decided);
    Scenario scenario = whoever_can();
    if (!decided) scenario.tasks[1] = when(scenario.tasks[1], Comparison::more, 20);
    scenario.tasks.push_back(anybodys("behind", {1}));
    // The lowest task before it is the cloud's: the cloud's node evaluates.
    scenario.tasks.push_back(when(task("last", "ur3", {1, 3}), Comparison::at_most, 20));
    Late story(Takers{{"carry", "cloud"}});
    story.fleet["conveyor"].sensors.plug("temperature", {15});
    story.submit(scenario);
    REQUIRE(story.ends());
    CHECK(story.seen("carry").state == TaskState::skipped);
    CHECK(story.seen("behind").state == TaskState::skipped);
    CHECK(story.seen("last").state == TaskState::finished);
    CHECK(story.view().epoch == (decided ? 2 : 1));
    CHECK(story.seen("carry").reason ==
          (decided ? "by decision of 'Ann': it is the nearest" : "temperature of conveyor was 15 degC, not > 20"));
  }
}

TEST_CASE("a condition that holds: evaluated once, before anybody is chosen, though who evaluated it is gone then") {
  for (const bool first : {false, true}) {
    CAPTURE(first);
    Scenario scenario = whoever_can();
    if (first) scenario.tasks[1].after.clear();  // nothing is before it: the cloud's node evaluates
    scenario.tasks[1] = when(scenario.tasks[1], Comparison::at_most, 20);
    Late story(Takers{});
    FakeSensor& sensor = story.fleet["conveyor"].sensors.plug("temperature", {15});
    story.submit(scenario);
    REQUIRE(story.fleet.until([&] { return story.seen("carry").outcome == TaskOutcome::released; }));
    REQUIRE(story.fleet.until([&] { return story.seen("fly").state == TaskState::finished; }));
    story.fleet.stop("ridgeback");
    story.takers = {{"carry", "pioneer"}};
    REQUIRE(story.ends());
    CHECK(sensor.asked == 1);
    CHECK(story.begun_by("pioneer") == 1);
  }
}

TEST_CASE("a pinned task is bound once, and never moved") {
  Scenario scenario = whoever_can();
  scenario.tasks[1].pinned = true;
  Late story(Takers{{"carry", "pioneer"}});
  story.fleet["pioneer"].adapter.endings = {{"carry", TaskOutcome::failed}};
  story.submit(scenario);
  REQUIRE(story.ends(RunState::paused));
  const SignedRecord move = story.decider.decision({{"carry", Ruling::move, "conveyor", 3, Evidence::result}});
  const Outbox out = story.fleet.tell("cloud", "cloud", MessageType::command, RunDecision{move});
  CHECK(sent<Nack>(out).at(0).code == "not_permitted");
}

TEST_CASE("in any weather each task is given to one robot, and done once") {
  for (std::uint64_t seed = 1; seed <= 12; ++seed) {
    CAPTURE(seed);
    Late story(Takers{{"carry", "pioneer"}}, seed);
    story.fleet.weather = {300, 200, 150, seconds(0.8)};
    story.submit(whoever_can(), "ridgeback");
    REQUIRE(story.ends());
    story.check_each_once();
    CHECK(story.begun_by("pioneer") == 1);
  }
}

TEST_CASE("any scheduler may die after any of its records while a robot is chosen") {
  die_at_every_record({"cloud", "ridgeback", "pioneer", "ur3", "drone"}, 60, [](const auto& victim, const Doom& doom) {
    Late story(Takers{{"carry", "pioneer"}});
    doom(story.fleet);
    story.submit(whoever_can());
    if (story.fleet.answers.empty()) story.fleet.until([&] { return story.fleet["cloud"].up; });
    REQUIRE(story.ends());
    story.check_each_once();
    CHECK(story.begun_by("pioneer") == 1);
    story.fleet.pass(seconds(10));
    return story.fleet[victim].crash.commits;
  });
}

TEST_CASE("what a cloud node may hold and say of a task is bounded") {
  Late story(Takers{});
  const auto submitted = [&](const std::function<void(RunStart&)>& change) {
    RunStart start = *decode<RunStart>(story.start(whoever_can()).payload.bytes);
    change(start);
    start.digest.bytes = digest(encode(start.scenario));
    const Outbox out = story.fleet.tell("cloud", "cloud", MessageType::command,
                                        RunSubmit{story.fleet.sign("cloud", kSignedRunStart, encode(start))});
    return sent<Nack>(out).empty() ? "" : sent<Nack>(out)[0].code;
  };
  CHECK(submitted([](RunStart& is) {
          is.scenario.tasks[0].robot = "cloud";
          is.first.robots[0] = "cloud";
        }) == "bad_value");
  story.fleet.add("cloud2", Role::cloud);
  CHECK(submitted([](RunStart& is) { is.first.robots[1] = "cloud2"; }) == "bad_value");
  CHECK(submitted([](RunStart&) {}).empty());

  REQUIRE(story.fleet.until([&] { return story.seen("carry").outcome == TaskOutcome::released; }));
  const auto said = [&](TaskOutcome outcome, std::uint32_t attempt) {
    TaskResult result;
    result.key = {kRun, "carry", 1, attempt};
    result.digest = decode<RunStart>(story.start(whoever_can()).payload.bytes)->digest;
    result.robot = "cloud";
    result.outcome = outcome;
    const Outbox out = story.fleet.tell("ur3", "cloud", MessageType::command,
                                        Results{kRun, {story.fleet.sign("cloud", kSignedResult, encode(result))}, {}});
    return sent<Nack>(out).empty() ? "" : sent<Nack>(out)[0].code;
  };
  REQUIRE(story.fleet.until([&] { return story.seen("fly").state == TaskState::finished; }));
  story.takers = {{"carry", "pioneer"}};
  REQUIRE(story.ends());
  CHECK(said(TaskOutcome::finished, 1) == "not_permitted");
  CHECK(said(TaskOutcome::failed, 1) == "not_permitted");
  CHECK(said(TaskOutcome::released, 2) == "not_permitted");
  CHECK(said(TaskOutcome::released, 1).empty());
}
