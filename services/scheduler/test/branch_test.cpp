// What goes on when something fails, and what does not: branches, `continue`, `start_within_s`, what was interrupted.
#include <doctest/doctest.h>

#include "common/scenario/run_start.hpp"
#include "common/scenario/test/make_task.hpp"
#include "services/scheduler/test/decision_story.hpp"

using namespace trb;
using namespace trb::scheduler;
using namespace trb::scheduler::test;

namespace {

Task named_task(const char* id, const char* robot, std::vector<TaskIndex> after,
                OnFailure then = OnFailure::resilience) {
  Task out = make_task(id, robot, id, std::move(after));
  out.on_failure = then;
  return out;
}

struct BranchStory {
  explicit BranchStory(std::vector<Task> tasks) : BranchStory() { submit(std::move(tasks)); }
  BranchStory() { add_demonstration(fleet); }
  void submit(std::vector<Task> tasks, std::uint32_t priority = 0, const std::string& run = kStoryRun) {
    Scenario scenario{"branches", "", std::move(tasks)};
    const UtcTime now = fleet.now().utc;
    RunStart start = build_run_start(scenario, fleet.members(), "cloud", now, now + seconds(3600), run);
    start.priority = priority;
    fleet.ask("cloud", MessageType::command, RunSubmit{fleet.sign("cloud", kSignedRunStart, encode(start))});
  }
  FakeAdapter& adapter(const std::string& robot) { return fleet[robot].adapter; }
  RunView view() { return fleet.view("cloud", kStoryRun); }
  bool ends(RunState state) {
    return fleet.until([&] { return view().state == state; }, seconds(300));
  }
  std::string decide(std::vector<TaskRuling> rulings) {
    const Decider decider(fleet, "ur3", {}, "pioneer");
    fleet.ask("cloud", MessageType::command, RunDecision{decider.decision(std::move(rulings))});
    const auto* nack = get_if<Nack>(&fleet.answers.back());
    return nack == nullptr ? "" : nack->code;
  }
  Fleet fleet;
};

}  // namespace

TEST_CASE("what does not follow the task that failed goes on, and the run says so") {
  BranchStory story({named_task("fetch", "ridgeback", {}), named_task("grip", "ur3", {0}),
                     named_task("pack", "ur3", {1}), named_task("fly", "drone", {0}), named_task("film", "drone", {3}),
                     named_task("land", "drone", {4})});
  story.adapter("ur3").ending = TaskOutcome::failed;
  story.adapter("drone").skill_time = seconds(5);
  REQUIRE(story.ends(RunState::paused));
  CHECK(story.view().waits_for ==
        "task 'grip' failed on 'ur3': the gripper is stuck; meanwhile goes on: 'fly' on 'drone'");
  story.fleet.pass(seconds(30));
  CHECK(story.view().tasks[5].state == TaskState::finished);
  CHECK(story.view().tasks[2].state == TaskState::waiting);
  CHECK(story.view().waits_for == "task 'grip' failed on 'ur3': the gripper is stuck");
  CHECK(story.view().tasks[1].failed_by == std::vector<std::string>{"ur3"});
}

TEST_CASE("a drone that could not film lands all the same, if the film is nothing to wait for") {
  for (const bool goes_on : {true, false}) {
    BranchStory story({named_task("take_off", "drone", {}),
                       named_task("film", "drone", {0}, goes_on ? OnFailure::continue_ : OnFailure::skip),
                       named_task("land", "drone", {1})});
    story.adapter("drone").endings["film"] = TaskOutcome::failed;
    REQUIRE(story.ends(RunState::finished));
    CHECK(story.view().tasks[1].state == TaskState::skipped);
    CHECK(story.view().tasks[1].reason == "failed, which skips it: the gripper is stuck");
    CHECK(story.view().tasks[2].state == (goes_on ? TaskState::finished : TaskState::skipped));
  }
}

TEST_CASE("a person who skips such a task lets what follows go on; a condition that does not hold does not") {
  BranchStory story({named_task("film", "ur3", {}, OnFailure::continue_), named_task("land", "drone", {0})});
  story.fleet["ur3"].cut = true;
  story.fleet.pass(seconds(5));
  REQUIRE(story.decide({{"film", Ruling::skip, "cloud", 2, Evidence::word}}).empty());
  REQUIRE(story.ends(RunState::finished));
  CHECK(story.view().tasks[1].state == TaskState::finished);
}

TEST_CASE("nobody says of another task, or of one that was done, that what follows goes on") {
  BranchStory story({named_task("film", "ur3", {}, OnFailure::skip), named_task("land", "drone", {0})});
  story.fleet.pass(seconds(0.1));
  const auto tell = [&](TaskOutcome outcome) {
    TaskResult lie;
    lie.key = {kStoryRun, "film", 1, 1};
    lie.digest = decode<RunStart>(get<JournalRun>(story.fleet["cloud"].journal[0]).start.payload.bytes)->digest;
    lie.robot = "ur3";
    lie.outcome = outcome;
    lie.goes_on = true;
    const SignedRecord record = story.fleet.sign("ur3", kSignedResult, encode(lie));
    const Outbox out = story.fleet.tell("cloud", "ur3", MessageType::command, Results{kStoryRun, {record}, {}});
    return sent<Nack>(out).empty() ? "" : sent<Nack>(out)[0].code;
  };
  CHECK(tell(TaskOutcome::skipped) == "bad_value");
  CHECK(tell(TaskOutcome::finished) == "bad_value");
}

TEST_CASE("what has not begun in its time has failed: what is nice to have holds up nobody") {
  BranchStory story;
  story.adapter("drone").set(false, false);
  Task film = named_task("film", "drone", {0}, OnFailure::continue_);
  film.start_within_s = 20;
  film.retries = 3;
  story.submit({named_task("fetch", "ridgeback", {}), film, named_task("grip", "ur3", {1})});
  story.fleet.pass(seconds(18));
  CHECK(story.view().tasks[1].state == TaskState::waiting);
  CHECK(story.fleet.view("drone", kStoryRun).tasks[1].due);
  CHECK(story.fleet.view("drone", kStoryRun).tasks[1].waits_for == "the robot is CONNECTION_BROKEN");
  REQUIRE(story.fleet.until([&] { return story.view().state == RunState::finished; }, seconds(10)));
  CHECK(story.view().tasks[1].state == TaskState::skipped);
  CHECK(story.view().tasks[1].reason == "it did not begin within 20 s: the robot is CONNECTION_BROKEN");
  CHECK(story.view().tasks[2].state == TaskState::finished);
}

TEST_CASE("a task that has begun waits for nobody, on no node, however long it takes") {
  for (const std::uint64_t seed : {1U, 2U, 3U, 4U, 5U, 6U}) {
    CAPTURE(seed);
    BranchStory story;
    story.fleet.weather = {0, 300, 0, seconds(0.001 * static_cast<double>(seed))};
    story.adapter("ur3").skill_time = seconds(60);
    story.submit(
        {named_task("fetch", "ridgeback", {}), named_task("grip", "ur3", {0}), named_task("pack", "drone", {1})});
    REQUIRE(story.fleet.until([&] { return story.view().tasks[1].state == TaskState::running; }));
    story.adapter("ur3").set(true, false);  // a word of its mode-adapter that changes nothing
    story.fleet.pass(seconds(20));
    for (const char* node : {"cloud", "ur3", "ridgeback"}) {
      const RunView view = story.fleet.view(node, kStoryRun);
      CHECK(view.waits_for == "");
      CHECK_FALSE(view.tasks[1].due);
    }
  }
}

TEST_CASE("the time to begin runs on when the robot refuses, and does not while a person holds the run") {
  BranchStory story;
  Task grip = named_task("grip", "ur3", {});
  grip.start_within_s = 20;
  story.adapter("ur3").set_control("ann");
  story.submit({grip});
  story.fleet.pass(seconds(10));
  const auto order = [&](std::uint32_t number, bool paused) {
    const PauseOrder is{kStoryRun, number, paused, "cloud", "", 0, {}};
    story.fleet.ask("cloud", MessageType::command, RunPause{story.fleet.sign("cloud", kSignedRunPause, encode(is))});
  };
  order(1, true);
  story.fleet.pass(seconds(60));
  CHECK(story.view().tasks[0].state == TaskState::waiting);
  order(2, false);
  story.fleet.pass(seconds(19));
  CHECK(story.view().tasks[0].state == TaskState::waiting);
  REQUIRE(story.fleet.until([&] { return story.view().state == RunState::paused; }, seconds(5)));
  CHECK(story.view().tasks[0].state == TaskState::failed);
  CHECK(story.adapter("ur3").begun.empty());
}

TEST_CASE("what was interrupted is tried again only if that does no harm; else it ends as its failure does") {
  struct Case {
    bool repeatable;
    OnFailure then;
    RunState state;
    TaskState task;
  };
  const Case cases[] = {{true, OnFailure::abort, RunState::finished, TaskState::finished},
                        {false, OnFailure::abort, RunState::aborted, TaskState::retriable},
                        {false, OnFailure::skip, RunState::finished, TaskState::skipped},
                        {false, OnFailure::resilience, RunState::paused, TaskState::retriable}};
  for (const Case& one : cases) {
    CAPTURE(name_of(one.state));
    BranchStory story;
    story.adapter("ur3").skills = {{"grip", "hands", one.repeatable}};
    story.adapter("ur3").skill_time = seconds(10);
    story.adapter("drone").skill_time = seconds(3);
    Task grip = named_task("grip", "ur3", {}, one.then);
    grip.retries = 1;
    std::vector<Task> tasks{grip};
    for (TaskIndex i = 0; i < 7; ++i) {
      tasks.push_back(named_task(("fly-" + std::to_string(i)).c_str(), "drone", {}));
      if (i > 0) tasks.back().after = {i};
    }
    story.submit(tasks);
    REQUIRE(story.fleet.until([&] { return story.adapter("ur3").begun.size() == 1; }));
    story.adapter("ur3").restart();
    REQUIRE(story.ends(one.state));
    CHECK(story.view().tasks[0].state == one.task);
    if (one.state == RunState::aborted) CHECK(story.adapter("drone").begun.size() <= 1);
  }
}

TEST_CASE("a failure that ends the run does so though its robot is gone with it") {
  BranchStory story({named_task("grip", "ur3", {}, OnFailure::abort), named_task("fly", "drone", {})});
  story.adapter("ur3").ending = TaskOutcome::failed;
  story.adapter("drone").skill_time = seconds(30);
  REQUIRE(story.fleet.until([&] { return story.view().tasks[0].outcome == TaskOutcome::failed; }));
  story.fleet.stop("ur3");
  story.fleet.pass(seconds(10));
  CHECK(story.view().state == RunState::aborting);
  CHECK(story.decide({{"grip", Ruling::skip, "cloud", 2, Evidence::result}}) == "conflict");
}

TEST_CASE("a task that its robot has refused is given back when it is asked for") {
  BranchStory story({named_task("grip", "ur3", {})});
  REQUIRE(story.fleet.until([&] { return story.fleet["ur3"].crash.commits > 0; }));
  story.adapter("ur3").set(false, false);
  story.fleet.pass(seconds(3));
  REQUIRE(story.adapter("ur3").begun.empty());
  story.fleet.hear("ur3", "cloud", MessageType::command, ReleaseTasks{kStoryRun, 1, {0}});
  REQUIRE(story.fleet.until([&] { return story.view().tasks[0].outcome == TaskOutcome::released; }, seconds(10)));
  story.adapter("ur3").set(true, false);
  story.fleet.pass(seconds(30));
  CHECK(story.adapter("ur3").begun.empty());
  REQUIRE(story.decide({{"grip", Ruling::move, "pioneer", 2, Evidence::result}}).empty());
  CHECK(story.ends(RunState::finished));
}

TEST_CASE("a robot of which somebody says that it stands is stopped before another begins its task") {
  for (const OnFailure on_failure : {OnFailure::resilience, OnFailure::skip, OnFailure::abort}) {
    CAPTURE(name_of(on_failure));
    Task grip = named_task("grip", "ur3", {});
    grip.on_failure = on_failure;
    BranchStory story({grip, named_task("fly", "drone", {0})});
    story.adapter("ur3").skill_time = seconds(60);  // it moves, whatever was seen
    REQUIRE(story.fleet.until([&] { return story.view().tasks[0].state == TaskState::running; }));
    story.fleet.hear("ur3", "cloud", MessageType::command, ReleaseTasks{kStoryRun, 1, {0}, true});
    REQUIRE(story.fleet.until([&] { return story.view().tasks[0].outcome == TaskOutcome::retriable; }, seconds(5)));
    story.fleet.pass(seconds(30));
    CHECK(story.adapter("ur3").begun.size() == 1);
    REQUIRE(story.decide({{"grip", Ruling::move, "pioneer", 2, Evidence::result}}).empty());
    CHECK(story.ends(RunState::finished));
    CHECK(story.fleet.counted["double_execution"] == 0);
  }
}

TEST_CASE("a robot that has finished before it hears that it is to stop has done its task") {
  BranchStory story({named_task("grip", "ur3", {}), named_task("fly", "drone", {0})});
  story.adapter("ur3").skill_time = seconds(2);
  REQUIRE(story.fleet.until([&] { return story.view().tasks[0].state == TaskState::running; }));
  story.fleet.pass(seconds(2));
  story.fleet.hear("ur3", "cloud", MessageType::command, ReleaseTasks{kStoryRun, 1, {0}, true});
  CHECK(story.ends(RunState::finished));
  CHECK(story.view().tasks[0].outcome == TaskOutcome::finished);
}

TEST_CASE("where every attempt is used up the task can still be skipped, and nothing else") {
  BranchStory story({named_task("grip", "ur3", {}), named_task("fly", "drone", {0})});
  story.adapter("ur3").ending = story.adapter("pioneer").ending = TaskOutcome::failed;
  REQUIRE(story.ends(RunState::paused));
  REQUIRE(story.decide({{"grip", Ruling::move, "pioneer", 64, Evidence::result}}).empty());
  REQUIRE(story.fleet.until([&] { return story.view().tasks[0].attempt == 64; }));
  story.fleet.pass(seconds(5));
  CHECK(story.decide({{"grip", Ruling::retry, "pioneer", 65, Evidence::result}}) == "bad_value");
  REQUIRE(story.decide({{"grip", Ruling::skip, "cloud", 65, Evidence::result}}).empty());
  CHECK(story.ends(RunState::finished));
  CHECK(story.view().tasks[0].state == TaskState::skipped);
}

TEST_CASE("a robot begins the run of the higher priority first, and of two alike the one that it served longest ago") {
  BranchStory story;
  const std::string second(32, 'b');
  const std::string urgent(32, 'c');
  const auto three = [] {
    return std::vector<Task>{named_task("one", "ur3", {}), named_task("two", "ur3", {}),
                             named_task("three", "ur3", {})};
  };
  story.submit(three());
  story.submit(three(), 0, second);
  REQUIRE(story.fleet.until([&] { return story.adapter("ur3").begun.size() == 2; }));
  story.submit(three(), 5, urgent);
  REQUIRE(story.fleet.until([&] { return story.adapter("ur3").begun.size() == 9; }));
  std::vector<std::pair<std::int64_t, char>> order;
  for (const std::string& run : {kStoryRun, second, urgent}) {
    for (const TaskView& one : story.fleet.view("ur3", run).tasks) order.emplace_back(one.started, run[0]);
  }
  // The last one runs still, without a time.
  std::ranges::sort(order);
  std::string turns;
  for (const auto& [at, run] : order) turns += at == 0 ? '\0' : run;
  std::erase(turns, '\0');
  CHECK(turns == "abcccaba");
}

TEST_CASE("after its journal is lost a robot begins nothing before somebody has looked at it") {
  BranchStory story({named_task("grip", "ur3", {}), named_task("pack", "ur3", {0})});
  story.adapter("ur3").skill_time = seconds(10);
  REQUIRE(story.fleet.until([&] { return story.adapter("ur3").begun.size() == 1; }));
  story.fleet.stop("ur3");
  story.fleet["ur3"].journal = {JournalLost{story.fleet.now().utc.ns, false}};
  story.fleet.weather.local_loss = 900;
  story.fleet.start("ur3");
  story.fleet.pass(seconds(20));
  story.fleet.weather.local_loss = 0;
  story.fleet.pass(seconds(60));
  CHECK(story.adapter("ur3").begun.size() == 1);
  REQUIRE(story.adapter("ur3").out_of_use.size() >= 1);
  CHECK(story.adapter("ur3").out_of_use[0].severity == Severity::fatal);
  // It is said once: a restart asks no more.
  story.fleet.stop("ur3");
  story.fleet.start("ur3");
  story.fleet.pass(seconds(5));
  const std::size_t said = story.adapter("ur3").out_of_use.size();
  story.fleet.pass(seconds(30));
  CHECK(story.adapter("ur3").out_of_use.size() == said);
  story.adapter("ur3").set_out_of_use({});
  // What became of the task only a person can say.
  REQUIRE(story.decide({{"grip", Ruling::retry, "ur3", 2, Evidence::word}}).empty());
  CHECK(story.ends(RunState::finished));
  CHECK(story.adapter("ur3").begun.size() == 3);
}

TEST_CASE("what a lost journal held is not done again if the run's decider has its result, also after a restart") {
  BranchStory story({named_task("grip", "ur3", {}), named_task("fly", "drone", {0}), named_task("pack", "ur3", {1}),
                     named_task("look", "ur3", {1})});
  story.adapter("drone").skill_time = seconds(10);
  REQUIRE(story.fleet.until([&] { return story.adapter("drone").begun.size() == 1; }));
  story.fleet.stop("ur3");
  story.fleet["ur3"].journal = {JournalLost{story.fleet.now().utc.ns, true}};
  story.fleet.start("ur3");
  REQUIRE(story.fleet.until([&] { return story.adapter("ur3").begun.size() == 2; }, seconds(60)));
  story.fleet.stop("ur3");
  story.fleet.start("ur3");
  CHECK(story.ends(RunState::finished));
  CHECK(story.adapter("ur3").begun.size() == 3);
}

TEST_CASE("after its journal is lost a robot does not begin what its run's decider cannot be asked about") {
  BranchStory story({named_task("grip", "ur3", {}), named_task("fly", "drone", {0}), named_task("pack", "ur3", {1})});
  story.adapter("drone").skill_time = seconds(10);
  REQUIRE(story.fleet.until([&] { return story.adapter("drone").begun.size() == 1; }));
  story.fleet.stop("ur3");
  story.fleet["ur3"].journal = {JournalLost{story.fleet.now().utc.ns, true}};
  story.fleet.stop("cloud");
  story.fleet.start("ur3");
  story.fleet.pass(seconds(60));
  CHECK(story.adapter("ur3").begun.size() == 1);
  story.fleet.start("cloud");
  CHECK(story.ends(RunState::finished));
  CHECK(story.adapter("ur3").begun.size() == 2);
}

TEST_CASE("a robot begins nothing that needs what is out of use, and the rest goes on") {
  BranchStory story;
  story.adapter("ur3").skills = {{"grip", "hands", false}, {"look", "eyes", false}};
  OutOfUse broken{"hands", Severity::critical, "gripper overheated", 0, false, ""};
  story.adapter("ur3").out_of_use = {broken};
  story.submit({named_task("grip", "ur3", {}), named_task("look", "ur3", {})});
  story.fleet.pass(seconds(20));
  const RunView view = story.fleet.view("ur3", kStoryRun);
  CHECK(view.tasks[0].state == TaskState::waiting);
  CHECK(view.waits_for.find("its 'hands' is out of use: CRITICAL: gripper overheated") != std::string::npos);
  OutOfUse retired{"", Severity::warning, "maintenance", 0, true, "ann"};
  story.adapter("ur3").set_out_of_use({retired});
  story.fleet.pass(seconds(20));
  CHECK(story.adapter("ur3").begun.size() <= 1);
  CHECK(story.fleet.view("ur3", kStoryRun).waits_for.find("out of service: maintenance (ann)") != std::string::npos);
  story.adapter("ur3").set_out_of_use({});
  CHECK(story.ends(RunState::finished));
}

TEST_CASE("what breaks as its task begins is what the run waits for, at the cloud, too, until it is mended") {
  BranchStory story;
  story.adapter("ur3").skills = {{"grip", "hands", false}};
  story.fleet.pass(seconds(2));
  // The scheduler has not heard of it: it journals the start, and the mode-adapter refuses.
  story.adapter("ur3").out_of_use = {{"hands", Severity::critical, "gripper overheated", 0, false, ""}};
  story.submit({named_task("grip", "ur3", {})});
  story.fleet.pass(seconds(3));
  const std::string wait =
      "task 'grip' on 'ur3': its 'hands' is out of use: CRITICAL: gripper overheated; once it is mended, and if the "
      "robot "
      "itself does not say so: trb robot repaired";
  CHECK(story.view().state == RunState::running);
  CHECK(story.view().tasks[0].state == TaskState::initializing);
  CHECK(story.view().waits_for == wait);
  story.fleet.stop("cloud");  // it forgets what it was told
  story.fleet.start("cloud");
  story.fleet.pass(seconds(12));
  CHECK(story.view().waits_for == wait);
  story.adapter("ur3").skill_time = seconds(5);
  story.adapter("ur3").set_out_of_use({});
  story.fleet.pass(seconds(2));
  CHECK(story.view().tasks[0].state == TaskState::running);
  CHECK(story.view().waits_for.empty());
  CHECK(story.ends(RunState::finished));
}
