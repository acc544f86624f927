// A run that a person holds and lets go on.
#include <doctest/doctest.h>

#include "services/scheduler/test/decision_story.hpp"

using namespace trb;
using namespace trb::scheduler::test;

namespace {

struct Held {
  Held() {
    add_demonstration(fleet);
    fleet.ask("cloud", MessageType::command, RunSubmit{start_without(fleet, nine_tasks(), {})});
  }
  SignedRecord order(std::uint32_t number, bool paused, const std::string& by = "cloud",
                     const std::vector<std::string>& doubles = {}) {
    return fleet.sign(by, kSignedRunPause, encode(PauseOrder{kStoryRun, number, paused, by, "lunch", 0, doubles}));
  }
  void say(std::uint32_t number, bool paused, const std::string& by = "cloud") {
    fleet.ask(by, MessageType::command, RunPause{order(number, paused, by)});
  }
  std::uint32_t number(const std::string& node) { return fleet.view(node, kStoryRun).pause_number; }
  std::string tell(const std::string& node, const std::string& source, const SignedRecord& record) {
    const Outbox out = fleet.tell(node, source, MessageType::command, RunPause{record});
    return sent<Nack>(out).empty() ? "" : sent<Nack>(out)[0].code;
  }
  Fleet fleet;
};

}  // namespace

TEST_CASE("what runs is finished, nothing is begun, until the run goes on") {
  Held story;
  REQUIRE(story.fleet.until([&] { return story.fleet.view("cloud", kStoryRun).tasks[0].state == TaskState::running; }));
  story.say(1, true);
  story.fleet.pass(seconds(60));
  const RunView view = story.fleet.view("cloud", kStoryRun);
  CHECK(view.state == RunState::paused);
  CHECK(view.paused_by == "cloud");
  CHECK(view.waits_for == "a person: held by 'cloud': lunch; trb scenario resume lets it go on");
  CHECK(view.tasks[0].state == TaskState::finished);
  CHECK(view.tasks[1].state == TaskState::waiting);
  story.say(2, false);
  REQUIRE(story.fleet.until([&] { return story.fleet.view("cloud", kStoryRun).state == RunState::finished; }));
}

TEST_CASE("a node that was away when the run was held is told; a restart does not forget") {
  Held story;
  story.fleet.stop("conveyor");
  story.say(1, true);
  story.fleet.pass(seconds(10));
  story.fleet.start("conveyor");
  story.fleet.stop("cloud");
  story.fleet.start("cloud");
  REQUIRE(story.fleet.until([&] { return story.fleet.view("conveyor", kStoryRun).paused_by == "cloud"; }, seconds(30)));
  CHECK(story.fleet.view("cloud", kStoryRun).state == RunState::paused);
}

TEST_CASE("of several orders the highest number counts, of two with one number the one that holds") {
  Held story;
  REQUIRE(story.fleet.until([&] { return story.fleet.view("conveyor", kStoryRun).run == kStoryRun; }));
  CHECK(story.tell("conveyor", "cloud", story.order(2, false)).empty());
  CHECK(story.tell("conveyor", "cloud", story.order(1, true)).empty());
  CHECK(story.fleet.view("conveyor", kStoryRun).paused_by.empty());
  CHECK(story.tell("conveyor", "ur3", story.order(2, true, "ur3")).empty());
  CHECK(story.fleet.view("conveyor", kStoryRun).paused_by == "ur3");
}

TEST_CASE("no number holds a run for ever") {
  Held story;
  REQUIRE(story.fleet.until([&] { return story.fleet.view("conveyor", kStoryRun).run == kStoryRun; }));
  for (const std::uint32_t number : {0U, 2001U, 0xFFFFFFFFU}) {
    CHECK(story.tell("conveyor", "ur3", story.order(number, true, "ur3")) == "bad_value");
  }
  CHECK(story.tell("conveyor", "ur3", story.order(2000, true, "ur3")).empty());
  CHECK(story.tell("conveyor", "cloud", story.order(3002, false)) == "bad_value");
  CHECK(story.tell("conveyor", "cloud", story.order(2001, false)).empty());
  CHECK(story.fleet.view("conveyor", kStoryRun).paused_by.empty());
}

TEST_CASE("no robot's order makes a run unholdable") {
  Held story;
  REQUIRE(story.fleet.until([&] { return story.fleet.view("conveyor", kStoryRun).run == kStoryRun; }));
  // Its stolen keys sign the last number that a robot has.
  CHECK(story.tell("conveyor", "ur3", story.order(1001, false, "ur3")).empty());
  REQUIRE(story.fleet.until([&] { return story.number("cloud") == 1001; }));
  story.say(story.number("cloud") + 1, true);
  const auto is_held = [&] { return story.fleet.view("conveyor", kStoryRun).paused_by == "cloud"; };
  REQUIRE(story.fleet.until(is_held, seconds(5)));
  CHECK(story.tell("conveyor", "ur3", story.order(1002, false, "ur3")) == "bad_value");
  CHECK(is_held());
}

TEST_CASE("a robot's order lets go what a cloud node holds once; held again, it stays so until a cloud node says") {
  Held story;
  REQUIRE(story.fleet.until([&] { return story.fleet.view("conveyor", kStoryRun).run == kStoryRun; }));
  story.say(story.number("cloud") + 1, true);
  REQUIRE(story.fleet.until([&] { return story.number("ur3") == 1; }, seconds(5)));
  story.say(2, false, "ur3");
  REQUIRE(story.fleet.until([&] { return story.fleet.view("cloud", kStoryRun).paused_by.empty(); }, seconds(5)));
  story.say(story.number("cloud") + 1, true);
  REQUIRE(story.fleet.until([&] { return story.fleet.view("ur3", kStoryRun).paused_by == "cloud"; }, seconds(5)));
  story.say(story.number("ur3") + 1, false, "ur3");
  CHECK(get<Nack>(story.fleet.answers.back()).hint == "say it on node 'cloud', or abort the run");
  // A robot's people can hold it as before, and a cloud node lets it go on.
  story.say(story.number("cloud") + 1, false);
  REQUIRE(story.fleet.until([&] { return story.fleet.view("ur3", kStoryRun).paused_by.empty(); }, seconds(5)));
  story.say(story.number("ur3") + 1, true, "ur3");
  REQUIRE(story.fleet.until([&] { return story.fleet.view("cloud", kStoryRun).paused_by == "ur3"; }, seconds(5)));
  story.say(story.number("cloud") + 1, false);
  CHECK(story.fleet.until([&] { return story.fleet.view("cloud", kStoryRun).state == RunState::finished; }));
}

TEST_CASE("a member that says what was done twice holds nothing, and the run goes on") {
  Held story;
  REQUIRE(story.fleet.until([&] { return story.fleet.view("conveyor", kStoryRun).run == kStoryRun; }));
  for (const char* node : {"cloud", "conveyor"}) {
    CHECK(story.tell(node, "ur3", story.order(1, true, "ur3", {"x"})) == "not_permitted");
    CHECK(story.tell(node, "ur3", story.order(2, false, "ur3")).empty());
    CHECK(story.tell(node, "ur3", story.order(3, false, "ur3", {"bring_box"})) == "not_permitted");
  }
  CHECK(story.fleet.until([&] { return story.fleet.view("cloud", kStoryRun).state == RunState::finished; }));
}

TEST_CASE("a forged order, a stranger's, and one for a run that is over are refused") {
  Held story;
  REQUIRE(story.fleet.until([&] { return story.fleet.view("conveyor", kStoryRun).run == kStoryRun; }));
  SignedRecord forged = story.order(1, true);
  forged.payload.bytes[forged.payload.bytes.find("lunch")] = 'p';
  CHECK(story.tell("conveyor", "cloud", forged) == "bad_signature");
  SignedRecord lent = story.order(1, true);
  lent.signer = "stranger";
  CHECK(story.tell("conveyor", "cloud", lent) == "not_permitted");
  REQUIRE(story.fleet.until([&] { return story.fleet.view("cloud", kStoryRun).state == RunState::finished; }));
  CHECK(story.tell("cloud", "cloud", story.order(1, true)) == "conflict");
}
