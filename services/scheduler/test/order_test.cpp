// Orders reach everybody, whoever is gone; a run that is held begins nothing, whatever happens meanwhile.
#include <doctest/doctest.h>

#include <algorithm>

#include "services/scheduler/test/decision_story.hpp"

using namespace trb;
using namespace trb::scheduler;
using namespace trb::scheduler::test;

namespace {

struct HeldStory {
  explicit HeldStory(const Scenario& scenario, const std::set<std::string>& left_out = {}) {
    add_demonstration(fleet);
    fleet.ask("cloud", MessageType::command, RunSubmit{start_without(fleet, scenario, left_out)});
  }
  void hold(std::uint32_t number, bool paused, const std::string& by = "cloud") {
    const PauseOrder order{kStoryRun, number, paused, by, "lunch", 0, {}};
    fleet.ask(by, MessageType::command, RunPause{fleet.sign(by, kSignedRunPause, encode(order))});
  }
  void abort(const std::string& by) { fleet.ask(by, MessageType::command, RunAbort{fleet.sign_order(by, kStoryRun)}); }
  RunState state(const std::string& node) { return fleet.view(node, kStoryRun).state; }
  TaskView task(std::size_t index, const std::string& node = "cloud") {
    return fleet.view(node, kStoryRun).tasks[index];
  }
  std::size_t begun(const std::string& robot) { return fleet[robot].adapter.begun.size(); }
  /// The cloud hears that ridgeback has done the first task a second time.
  void tell_second_result() {
    TaskResult second;
    second.key = {kStoryRun, "task-0", 1, 1};
    second.digest = decode<RunStart>(get<JournalRun>(fleet["cloud"].journal[0]).start.payload.bytes)->digest;
    second.robot = "ridgeback";
    second.outcome = TaskOutcome::finished;
    const SignedRecord record = fleet.sign("ridgeback", kSignedResult, encode(second));
    fleet.hear("cloud", "ridgeback", MessageType::command, Results{kStoryRun, {record}, {}});
  }
  bool until(const std::function<bool()>& done, Duration limit = seconds(120)) { return fleet.until(done, limit); }
  Fleet fleet;
};

}  // namespace

TEST_CASE("a task that its robot has refused does not begin in a run that is held") {
  HeldStory story(chain({"ur3", "drone"}));
  story.fleet["ur3"].adapter.set_control("ann");
  story.fleet["ur3"].crash.at = 0;
  // The robot was ready when it was commanded, and is not when the command comes.
  story.fleet["ur3"].adapter.set_control("");
  REQUIRE(story.until([&] { return !story.fleet["ur3"].journal.empty(); }));
  story.fleet["ur3"].adapter.set_control("ann");
  story.fleet.pass(seconds(3));
  REQUIRE(story.begun("ur3") == 0);
  story.hold(1, true);
  story.fleet.pass(seconds(3));
  story.fleet["ur3"].adapter.set_control("");
  story.fleet.pass(seconds(60));
  CHECK(story.begun("ur3") == 0);
  story.hold(2, false);
  CHECK(story.until([&] { return story.state("cloud") == RunState::finished; }));
}

TEST_CASE("who becomes a member while the run is held hears of that first") {
  HeldStory story(chain({"ur3", "drone"}), {"pioneer"});
  story.fleet["ur3"].adapter.ending = TaskOutcome::failed;
  REQUIRE(story.until([&] { return story.task(0).state == TaskState::failed; }));
  story.hold(1, true);
  story.fleet.pass(seconds(2));
  const Decider decider(story.fleet, "ur3", {}, "pioneer");
  story.fleet.ask(
      "cloud", MessageType::command,
      RunDecision{decider.decision({{"task-0", Ruling::move, "pioneer", 2, Evidence::result}}, {"pioneer"})});
  story.fleet.pass(seconds(60));
  CHECK(story.fleet.view("pioneer", kStoryRun).paused_by == "cloud");
  CHECK(story.begun("pioneer") == 0);
  story.hold(2, false);
  CHECK(story.until([&] { return story.state("cloud") == RunState::finished; }));
  CHECK(story.begun("pioneer") == 1);
}

TEST_CASE("an order is told on by whoever knows it, when the node that gave it is dead") {
  HeldStory story(chain({"ur3", "ridgeback", "ridgeback", "drone", "drone"}));
  story.fleet["ridgeback"].adapter.skill_time = seconds(5);
  REQUIRE(story.until([&] { return story.begun("ridgeback") == 1; }));
  story.fleet["ridgeback"].cut = true;
  story.abort("ur3");
  REQUIRE(story.until([&] { return story.state("cloud") == RunState::aborting; }));
  story.fleet.stop("ur3");
  story.fleet.pass(seconds(1));
  story.fleet["ridgeback"].cut = false;
  REQUIRE(story.until([&] { return story.state("ridgeback") == RunState::aborting; }, seconds(5)));
  story.fleet.pass(seconds(60));
  CHECK(story.begun("ridgeback") == 1);
  CHECK(story.begun("drone") == 0);
  // Who has not confirmed is named: the dead one, too.
  CHECK(story.state("cloud") == RunState::aborting);
  CHECK(story.fleet.view("cloud", kStoryRun).waits_for == "the confirmation of 'ur3'");
  story.fleet.start("ur3");
  CHECK(story.until([&] { return story.state("cloud") == RunState::aborted; }, seconds(10)));
}

TEST_CASE("ABORTED is said once all have confirmed, by every node alike") {
  HeldStory story(chain({"ur3", "drone"}));
  story.fleet["drone"].cut = true;
  REQUIRE(story.until([&] { return story.begun("ur3") == 1; }));
  story.abort("ur3");
  story.fleet.pass(seconds(20));
  for (const char* node : {"cloud", "conveyor", "pioneer", "ridgeback", "ur3"}) {
    CAPTURE(node);
    CHECK(story.state(node) == RunState::aborting);
  }
  story.fleet["drone"].cut = false;
  CHECK(story.until(
      [&] {
        const auto members = story.fleet.members();
        return std::ranges::all_of(members,
                                   [&](const Member& member) { return story.state(member.id) == RunState::aborted; });
      },
      seconds(10)));
  CHECK(story.begun("drone") == 0);
}

TEST_CASE("what was told to be ABORTED stays so, also if the cloud is killed then and a robot is switched off") {
  HeldStory story(chain({"ur3", "drone"}));
  story.fleet.pass(seconds(0.5));
  story.abort("cloud");
  REQUIRE(story.until([&] { return story.state("cloud") == RunState::aborted; }));
  story.fleet.stop("drone");
  story.fleet.stop("cloud");
  story.fleet.start("cloud");
  story.fleet.pass(seconds(120));
  CHECK(story.state("cloud") == RunState::aborted);
}

TEST_CASE("a run that is aborted goes to the archive without a stolen node, once its certificate is revoked") {
  HeldStory story(chain({"ur3", "drone"}));
  story.fleet["drone"].cut = true;
  REQUIRE(story.until([&] { return story.begun("ur3") == 1; }));
  story.abort("ur3");
  story.fleet.pass(seconds(20));
  const std::vector<std::string> others = {"cloud", "conveyor", "pioneer", "ridgeback", "ur3"};
  for (const std::string& node : others) {
    story.fleet.tell(node, node, MessageType::information, PeerExpired{"drone", "cert_revoked: stolen"});
  }
  const auto is_archived = [&](const std::string& node) { return story.fleet[node].archive->size() == 1; };
  CHECK(story.until([&] { return std::ranges::all_of(others, is_archived); }, seconds(90)));
  for (const std::string& node : others) CHECK(story.state(node) == RunState::aborted);
}

TEST_CASE("a stolen node that is back with new keys and its old journal is told of the abort, and begins no more") {
  HeldStory story(chain({"ur3", "ur3", "ur3"}));
  Node& ur3 = story.fleet["ur3"];
  const std::vector<std::string> others = {"cloud", "conveyor", "drone", "pioneer", "ridgeback"};
  const auto tell_others = [&](const auto& body) {
    for (const std::string& node : others) story.fleet.tell(node, node, MessageType::information, body);
  };
  std::size_t most_begun = 1;
  REQUIRE(story.until([&] { return story.begun("ur3") == 1; }));
  ur3.adapter.set_control("ann");
  SUBCASE("it owes a result, and says so before its robot is free") {
    ur3.cut = true;
    story.fleet.pass(seconds(5));
  }
  SUBCASE("it owes nothing: that it begins its next task is the first that it says") {
    REQUIRE(story.until([&] { return story.task(0).state == TaskState::finished; }));
    story.fleet.pass(seconds(2));
    ur3.cut = true;
    ur3.adapter.skill_time = seconds(10);
    most_begun = 2;
  }
  story.fleet.stop("ur3");
  tell_others(PeerExpired{"ur3", "cert_revoked: stolen"});
  story.abort("cloud");
  const auto is_archived = [&](const std::string& node) {
    return story.fleet[node].archive->over(kStoryRun) && story.state(node) == RunState::aborted;
  };
  const auto knows = [&](const std::string& node) { return !story.fleet.view(node, kStoryRun).run.empty(); };
  REQUIRE(story.until([&] {
    return std::ranges::all_of(others, [&](const auto& node) { return !knows(node) || is_archived(node); });
  }));
  REQUIRE(is_archived("cloud"));
  story.fleet.give_new_keys("ur3");
  ur3.cut = false;
  story.fleet.start("ur3");
  tell_others(PeerJoined{"ur3", 2});
  story.fleet.pass(seconds(2));
  ur3.adapter.set_control("");
  story.fleet.pass(seconds(120));
  CHECK(story.begun("ur3") <= most_begun);
  const RunState state = story.state("ur3");
  CHECK((state == RunState::aborting || state == RunState::aborted));
  CHECK(story.fleet.carried["run_abort"] < 1000);
}

TEST_CASE("a task done twice holds the run on every node, until a person has looked and lets it go on") {
  HeldStory story(chain({"ridgeback", "ur3", "drone", "drone"}));
  story.fleet["ur3"].adapter.skill_time = seconds(30);
  REQUIRE(story.until([&] { return story.begun("ur3") == 1; }));
  story.tell_second_result();
  CHECK(story.state("cloud") == RunState::paused);
  REQUIRE(story.until([&] { return story.fleet.view("drone", kStoryRun).paused_by == "cloud"; }, seconds(5)));
  story.fleet.pass(seconds(60));
  CHECK(story.begun("drone") == 0);
  const RunView view = story.fleet.view("cloud", kStoryRun);
  CHECK(view.tasks[0].twice);
  CHECK(view.waits_for ==
        "a person: held by 'cloud': task 'task-0' has two different results (double_execution); trb scenario resume "
        "lets it go on");
  // An order that does not name it lets nothing go on: nobody has looked.
  story.hold(view.pause_number + 1, false);
  CHECK(get<Nack>(story.fleet.answers.back()).code == "conflict");
  story.hold(view.pause_number + 1, false, "ridgeback");
  story.fleet.pass(seconds(10));
  CHECK(story.begun("drone") == 0);
  const PauseOrder order{kStoryRun, view.pause_number + 3, false, "cloud", "looked at", 0, {"task-0"}};
  story.fleet.ask("cloud", MessageType::command, RunPause{story.fleet.sign("cloud", kSignedRunPause, encode(order))});
  story.fleet.pass(seconds(0.5));
  // From then on it is held and let go on as any other.
  CHECK_FALSE(story.task(0).twice);
  story.hold(view.pause_number + 4, true);
  story.fleet.pass(seconds(10));
  CHECK(story.fleet.view("cloud", kStoryRun).waits_for.find("lunch") != std::string::npos);
  story.hold(view.pause_number + 5, false);
  CHECK(story.until([&] { return story.state("cloud") == RunState::finished; }));
  CHECK(story.begun("drone") == 2);
}

TEST_CASE("who lets a run go on without having heard that a task was done twice is held with the others") {
  HeldStory story(chain({"ridgeback", "ur3", "drone", "drone"}));
  story.fleet["ur3"].adapter.skill_time = seconds(30);
  REQUIRE(story.until([&] { return story.begun("ur3") == 1; }));
  story.hold(1, true);
  story.fleet.pass(seconds(1));
  story.fleet["drone"].cut = true;
  story.hold(2, false);
  story.tell_second_result();
  REQUIRE(story.until([&] { return story.fleet.view("ur3", kStoryRun).pause_number == 3; }, seconds(5)));
  // The drone has heard of the first order alone, and of somebody who counts on.
  story.hold(7, false, "drone");
  story.fleet["drone"].cut = false;
  const auto all_hold = [&] {
    const std::vector<std::string> nodes{"cloud", "drone", "ur3"};
    return std::ranges::all_of(nodes, [&](const std::string& node) {
      return story.fleet.view(node, kStoryRun).paused_by == "cloud" &&
             story.fleet.view(node, kStoryRun).pause_number == 8;
    });
  };
  CHECK(story.until(all_hold, seconds(20)));
  story.fleet.pass(seconds(60));
  CHECK(story.begun("drone") == 0);
}
