// A robot fails, a decision makes the next epoch, the run goes on: in virtual time, in any weather, whoever dies.
#include <doctest/doctest.h>

#include "services/scheduler/test/crashes.hpp"
#include "services/scheduler/test/decision_story.hpp"

using namespace trb;
using namespace trb::scheduler::test;

namespace {

/// The ridgeback fails at task 4, "approach"; the pioneer, which is no member of the run, takes over tasks 4 and 7.
struct DecidedStory {
  explicit DecidedStory(std::uint64_t seed = 1) : fleet(seed) {
    add_demonstration(fleet);
    fleet["ridgeback"].adapter.endings = {{"approach", TaskOutcome::failed}};
  }
  void submit() {
    fleet.ask("cloud", MessageType::command, RunSubmit{start_without(fleet, ridgeback_does_it(), {"pioneer"})});
  }
  bool run() {
    const auto done = [&] {
      decider.step();
      return fleet["cloud"].up && fleet.view("cloud", kStoryRun).state == RunState::finished;
    };
    for (int s = 0; s < 600; ++s) {
      if (fleet.until(done, seconds(1))) return true;
      fleet.pass(seconds(0.1));  // where nothing happens, the decider's own time still passes
    }
    return false;
  }
  /// Until somebody has to decide.
  void pause() {
    submit();
    REQUIRE(fleet.until([&] { return fleet.view("cloud", kStoryRun).state == RunState::paused; }));
  }
  int begun(const std::string& robot, const std::string& task) {
    int out = 0;
    for (const auto& [key, times] : fleet[robot].adapter.begun) out += key.second.task == task ? times : 0;
    return out;
  }
  void check_done_right() {
    for (const char* task : {"bring_box", "load_out"}) CHECK_MESSAGE(begun("ridgeback", task) == 1, task);
    CHECK(begun("ridgeback", "approach") == 1);
    CHECK(begun("ridgeback", "go_back") == 0);
    for (const char* task : {"approach", "go_back"}) CHECK_MESSAGE(begun("pioneer", task) == 1, task);
    for (const char* robot : {"ridgeback", "pioneer", "ur3", "drone", "conveyor"}) {
      for (const auto& [key, times] : fleet[robot].adapter.commanded) CHECK(times >= 1);
      for (const auto& [key, times] : fleet[robot].adapter.begun) CHECK(times == 1);
    }
    CHECK(fleet.counted["double_execution"] == 0);
  }
  std::string answer(const std::string& node, const SignedRecord& decision) {
    const Outbox out = fleet.tell(node, "cloud", MessageType::command, RunDecision{decision});
    const auto nacks = sent<Nack>(out);
    if (!nacks.empty()) return nacks[0].code;
    return sent<DecisionJournaled>(out).empty() ? "" : "journaled";
  }

  Fleet fleet;
  Decider decider{fleet, "ridgeback", {"approach", "go_back"}, "pioneer"};
};

}  // namespace

TEST_CASE("who has taken a task over is seen at work on it") {
  DecidedStory story;
  story.pause();
  const auto seen = [&] {
    story.decider.step();
    const TaskView task = story.fleet.view("cloud", kStoryRun).tasks[3];
    return task.robot == "pioneer" && task.state == TaskState::running;
  };
  bool found = false;
  for (int s = 0; s < 60 && !found; ++s) {
    found = story.fleet.until(seen, seconds(1));
    story.fleet.pass(seconds(0.1));
  }
  CHECK(found);
}

TEST_CASE("the failed robot's tasks go to another one, and it goes on with what it can still do") {
  DecidedStory story;
  story.pause();
  const RunView paused = story.fleet.view("cloud", kStoryRun);
  CHECK(paused.tasks[3].state == TaskState::failed);
  CHECK(paused.waits_for == "task 'approach' failed on 'ridgeback': the gripper is stuck");
  REQUIRE(story.run());
  story.check_done_right();
  CHECK(story.decider.decided == 1);
  const RunView view = story.fleet.view("cloud", kStoryRun);
  CHECK(view.epoch == 2);
  CHECK(view.tasks[3].robot == "pioneer");
  CHECK(view.tasks[3].moved_from == "ridgeback");
  CHECK(view.tasks[3].attempt == 2);
  CHECK(view.tasks[8].robot == "ridgeback");
  CHECK(view.tasks[8].moved_from.empty());
  REQUIRE(view.decisions.size() == 1);
  CHECK(view.decisions[0].person == "Ann");
  CHECK(view.decisions[0].tasks.size() == 2);
  story.fleet.pass(seconds(5));
  // To the five other members, the new one among them.
  CHECK(story.fleet.carried["run_decision"] == 5);
  CHECK(story.fleet.carried["decision_journaled"] == 5);
}

TEST_CASE("in any weather a task is moved once, and done once by whom it was moved to") {
  for (std::uint64_t seed = 1; seed <= 12; ++seed) {
    CAPTURE(seed);
    DecidedStory story(seed);
    story.fleet.weather = {300, 200, 150, seconds(0.8)};
    story.submit();
    REQUIRE(story.run());
    story.check_done_right();
  }
}

TEST_CASE("any scheduler may die after any of its records while a robot is replaced") {
  die_at_every_record({"cloud", "ridgeback", "pioneer", "ur3", "drone"}, 120, [](const auto& victim, const Doom& doom) {
    DecidedStory story;
    doom(story.fleet);
    story.submit();
    if (story.fleet.answers.empty()) story.fleet.until([&] { return story.fleet["cloud"].up; });
    REQUIRE(story.run());
    story.check_done_right();
    story.fleet.pass(seconds(10));
    return story.fleet[victim].crash.commits;
  });
}

TEST_CASE("a robot that comes back after it was replaced is told the epoch, and stands down") {
  DecidedStory story;
  story.fleet["ridgeback"].adapter.endings.clear();
  story.fleet["ridgeback"].adapter.skill_time = seconds(20);
  story.submit();
  REQUIRE(story.fleet.until([&] { return story.fleet.view("cloud", kStoryRun).tasks[3].state == TaskState::running; }));
  story.fleet["ridgeback"].cut = true;  // it drives on, and nobody hears of it
  story.fleet.ask("cloud", MessageType::command,
                  RunDecision{story.decider.decision({{"approach", Ruling::move, "pioneer", 2, Evidence::word},
                                                      {"go_back", Ruling::move, "pioneer", 2, Evidence::word}},
                                                     {"pioneer"})});
  story.fleet.pass(seconds(3));
  story.fleet["ridgeback"].cut = false;
  REQUIRE(story.run());
  CHECK(story.begun("pioneer", "approach") == 1);
  CHECK(story.begun("ridgeback", "go_back") == 0);
  const RunView its = story.fleet.view("ridgeback", kStoryRun);
  CHECK(its.epoch == 2);
  CHECK(its.tasks[3].robot == "pioneer");
  CHECK(story.fleet.counted["double_execution"] == 0);
}

TEST_CASE("what a replaced robot tried on its own while it was cut off says nothing of the one that has the task now") {
  DecidedStory story;
  Scenario scenario = ridgeback_does_it();
  scenario.tasks[3].retries = 1;
  story.fleet["pioneer"].adapter.skill_time = seconds(60);
  story.fleet.ask("cloud", MessageType::command, RunSubmit{start_without(story.fleet, scenario, {"pioneer"})});
  REQUIRE(story.fleet.until([&] { return story.fleet.view("cloud", kStoryRun).tasks[3].state == TaskState::running; }));
  story.fleet["ridgeback"].cut = true;  // it fails, and fails again, as often as the task says
  story.fleet.ask(
      "cloud", MessageType::command,
      RunDecision{story.decider.decision({{"approach", Ruling::move, "pioneer", 3, Evidence::word}}, {"pioneer"})});
  story.fleet.pass(seconds(10));
  CHECK(story.begun("ridgeback", "approach") == 2);
  story.fleet["ridgeback"].cut = false;
  story.fleet.pass(seconds(10));
  CHECK(story.fleet.view("cloud", kStoryRun).state == RunState::running);
  CHECK(story.fleet.view("cloud", kStoryRun).waits_for.empty());
  REQUIRE(story.fleet.until([&] { return story.fleet.view("cloud", kStoryRun).state == RunState::finished; }));
  CHECK(story.fleet.view("cloud", kStoryRun).tasks[3].reason.empty());
  CHECK(story.begun("pioneer", "approach") == 1);
}

TEST_CASE(
    "a robot that had finished after all is found out: the run is PAUSED, for the task may have been done twice") {
  DecidedStory story;
  story.fleet["ridgeback"].adapter.endings.clear();
  story.submit();
  REQUIRE(story.fleet.until([&] { return story.fleet.view("cloud", kStoryRun).tasks[3].state == TaskState::running; }));
  story.fleet["ridgeback"].cut = true;
  story.fleet.ask(
      "cloud", MessageType::command,
      RunDecision{story.decider.decision({{"approach", Ruling::move, "pioneer", 2, Evidence::word}}, {"pioneer"})});
  REQUIRE(
      story.fleet.until([&] { return story.fleet.view("cloud", kStoryRun).tasks[3].state == TaskState::finished; }));
  story.fleet["ridgeback"].cut = false;
  REQUIRE(story.fleet.until([&] { return story.fleet.counted["double_execution"] > 0; }));
  CHECK(story.fleet.view("cloud", kStoryRun).state == RunState::paused);
}

TEST_CASE("the same robot tries again when that is decided") {
  DecidedStory story;
  story.pause();
  story.fleet["ridgeback"].adapter.endings.clear();
  story.fleet.ask("cloud", MessageType::command,
                  RunDecision{story.decider.decision({{"approach", Ruling::retry, "ridgeback", 2}})});
  REQUIRE(story.fleet.until([&] { return story.fleet.view("cloud", kStoryRun).state == RunState::finished; }));
  CHECK(story.begun("ridgeback", "approach") == 2);
  CHECK(story.fleet.view("cloud", kStoryRun).tasks[3].attempt == 2);
}

TEST_CASE("a task that is skipped is so said by the decider's node, and the run goes on behind it") {
  DecidedStory story;
  story.pause();
  story.fleet.ask("cloud", MessageType::command,
                  RunDecision{story.decider.decision({{"approach", Ruling::skip, "cloud", 2}})});
  REQUIRE(story.fleet.until([&] { return story.fleet.view("cloud", kStoryRun).state == RunState::finished; }));
  const RunView view = story.fleet.view("cloud", kStoryRun);
  CHECK(view.tasks[3].state == TaskState::skipped);
  CHECK(view.tasks[3].reason == "by decision of 'Ann': it is the nearest");
  // Its only successors are skipped with it, as behind any SKIPPED task; the join behind them too.
  CHECK(view.tasks[6].state == TaskState::skipped);
  CHECK(story.begun("ridgeback", "go_back") == 0);
}

TEST_CASE("a condition behind a skipped task is evaluated by the decider's node, whose the task is now") {
  DecidedStory story;
  Scenario scenario;
  scenario.name = "behind";
  scenario.tasks = chain({"ridgeback", "pioneer", "ur3"}).tasks;
  scenario.tasks[1].after = {};
  scenario.tasks[2].after = {0, 1};
  scenario.tasks[2].when = {{"temperature", "conveyor", "", Comparison::at_most, false, 20, "", "degC"}};
  story.fleet["conveyor"].sensors.plug("temperature", {15});
  story.fleet["ridgeback"].adapter.endings = {{"task-0", TaskOutcome::failed}};
  story.fleet.ask("cloud", MessageType::command, RunSubmit{start_without(story.fleet, scenario, {})});
  REQUIRE(story.fleet.until([&] { return story.fleet.view("cloud", kStoryRun).state == RunState::paused; }));
  story.fleet.ask("cloud", MessageType::command,
                  RunDecision{story.decider.decision({{"task-0", Ruling::skip, "cloud", 2}})});
  REQUIRE(story.fleet.until([&] { return story.fleet.view("cloud", kStoryRun).state == RunState::finished; }));
  CHECK(story.begun("ur3", "task-2") == 1);
}

TEST_CASE("a decision that is not the decider's, not the next, or not possible is refused and leaves no trace") {
  DecidedStory story;
  story.pause();
  const TaskRuling move{"approach", Ruling::move, "pioneer", 2, Evidence::result};
  const auto decide = [&](const TaskRuling& ruling, const std::function<void(Decision&)>& change = {}) {
    return story.answer("cloud", story.decider.decision({ruling}, {"pioneer"}, change));
  };
  const auto of = [&](const std::function<void(TaskRuling&)>& change) {
    TaskRuling out = move;
    change(out);
    return out;
  };
  CHECK(decide(move, [](Decision& is) { is.by = "ur3"; }) == "source_mismatch");
  CHECK(decide(move, [](Decision& is) { is.epoch = 3; }) == "conflict");
  CHECK(decide(move, [](Decision& is) { is.epoch = 1; }) == "conflict");
  CHECK(decide(move, [](Decision& is) { is.previous.bytes = Bytes(32, 'x'); }) == "conflict");
  CHECK(decide(move, [](Decision& is) { is.digest.bytes[0] ^= 1; }) == "conflict");
  CHECK(decide(move, [](Decision& is) { is.tasks.clear(); }) == "bad_value");
  CHECK(decide(move, [](Decision& is) { is.tasks.push_back(is.tasks[0]); }) == "duplicate");
  CHECK(decide(move, [](Decision& is) { is.members.push_back(is.members[0]); }) == "duplicate");
  CHECK(decide(move, [](Decision& is) { is.members[0].id = "ur3"; }) == "source_mismatch");
  CHECK(decide(move, [](Decision& is) { is.members.clear(); }) == "bad_value");
  CHECK(decide(of([](TaskRuling& is) { is.task = "dance"; })) == "bad_value");
  CHECK(decide(of([](TaskRuling& is) { is.attempt = 1; })) == "bad_value");
  CHECK(decide(of([](TaskRuling& is) { is.attempt = 65; })) == "bad_value");
  CHECK(decide(of([](TaskRuling& is) { is.robot = "ridgeback"; })) == "bad_value");
  CHECK(decide(of([](TaskRuling& is) { is.robot = "cloud"; })) == "bad_value");
  CHECK(decide(of([](TaskRuling& is) { is.ruling = Ruling::retry; })) == "bad_value");
  CHECK(decide(of([](TaskRuling& is) { is.ruling = Ruling::skip; })) == "bad_value");
  SignedRecord robots = story.decider.decision({move}, {"pioneer"});
  robots.signer = "ur3";
  CHECK(story.answer("cloud", robots) == "not_permitted");
  SignedRecord forged = story.decider.decision({move}, {"pioneer"});
  forged.payload.bytes.back() = static_cast<char>(forged.payload.bytes.back() ^ 1);
  CHECK(story.answer("cloud", forged) == "bad_signature");
  CHECK(story.fleet.view("cloud", kStoryRun).epoch == 1);
}

TEST_CASE("a decision that comes again is confirmed again; another one of its epoch is refused") {
  DecidedStory story;
  story.pause();
  const TaskRuling move{"approach", Ruling::move, "pioneer", 2, Evidence::result};
  const SignedRecord first = story.decider.decision({move}, {"pioneer"});
  const SignedRecord other = story.decider.decision({move}, {"pioneer"}, [](Decision& is) { is.reason = "no"; });
  CHECK(story.answer("ur3", first) == "journaled");
  CHECK(story.answer("ur3", first) == "journaled");
  CHECK(story.answer("ur3", other) == "conflict");
  CHECK(story.fleet.view("ur3", kStoryRun).epoch == 2);
}

TEST_CASE("a pinned task stays where it is") {
  Fleet fleet;
  add_demonstration(fleet);
  Scenario scenario = ridgeback_does_it();
  scenario.tasks[3].pinned = true;
  fleet["ridgeback"].adapter.endings = {{"approach", TaskOutcome::failed}};
  fleet.ask("cloud", MessageType::command, RunSubmit{start_without(fleet, scenario, {})});
  REQUIRE(fleet.until([&] { return fleet.view("cloud", kStoryRun).state == RunState::paused; }));
  const Decider decider(fleet, "", {}, "");
  const Outbox out =
      fleet.tell("cloud", "cloud", MessageType::command,
                 RunDecision{decider.decision({{"approach", Ruling::move, "pioneer", 2, Evidence::result}})});
  CHECK(sent<Nack>(out).at(0).code == "not_permitted");
}

TEST_CASE("a task is given back only to the decider, in this epoch, and only if it has not begun") {
  DecidedStory story;
  story.pause();
  const auto ask = [&](const std::string& source, std::uint32_t epoch, std::vector<std::uint16_t> tasks) {
    const Outbox out =
        story.fleet.tell("ridgeback", source, MessageType::command, ReleaseTasks{kStoryRun, epoch, tasks});
    return sent<Nack>(out).empty() ? "" : sent<Nack>(out)[0].code;
  };
  CHECK(ask("ur3", 1, {6}) == "not_permitted");
  CHECK(ask("cloud", 2, {6}) == "conflict");
  CHECK(ask("cloud", 1, {5}) == "bad_value");
  CHECK(ask("cloud", 1, {900}) == "bad_value");
  CHECK(ask("cloud", 1, {3, 6}).empty());
  REQUIRE(story.fleet.until(
      [&] { return story.fleet.view("cloud", kStoryRun).tasks[6].outcome == TaskOutcome::released; }, seconds(10)));
  CHECK(story.fleet.view("cloud", kStoryRun).tasks[3].outcome == TaskOutcome::failed);
}

TEST_CASE("whoever watches is told of every change until its lease ends") {
  DecidedStory story;
  story.fleet.ask("cloud", MessageType::request, RunWatch{60});
  REQUIRE(story.fleet.answers.size() == 1);
  CHECK(get<RunTable>(story.fleet.answers[0]).runs.empty());
  story.pause();
  const auto states = [&] {
    std::set<RunState> out;
    for (const Body& answer : story.fleet.answers) {
      if (const auto* changed = get_if<RunChanged>(&answer)) out.insert(changed->run.state);
    }
    return out;
  };
  CHECK(states() == std::set<RunState>{RunState::running, RunState::paused});
  REQUIRE(story.run());
  CHECK(states().contains(RunState::finished));
  story.fleet.pass(seconds(60));
  const std::size_t before = story.fleet.answers.size();
  story.fleet.ask("cloud", MessageType::command, RunAbort{story.fleet.sign_order("cloud", kStoryRun)});
  CHECK(story.fleet.answers.size() == before + 1);  // its answer alone
  const Outbox bad = story.fleet.tell("cloud", "cloud", MessageType::request, RunWatch{0});
  CHECK(sent<Nack>(bad).at(0).code == "bad_value");
}
