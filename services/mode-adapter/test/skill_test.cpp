// Skills: one at a time, each attempt with one outcome, sent until it is journaled.
#include "services/mode-adapter/test/fixture.hpp"

using namespace trb;
using namespace trb::adapter;

namespace {

class SkillFixture : public Fixture {
 public:
  explicit SkillFixture(Settings settings = pioneer()) : Fixture(std::move(settings)) { up(Channel::field); }
  std::uint64_t execute(const Execute& order) { return deliver(MessageType::command, order, "pioneer"); }
  std::uint64_t query(std::uint32_t number = 1) {
    return deliver(MessageType::request, ExecutionQuery{attempt(number)}, "pioneer");
  }
  std::uint64_t cancel(std::uint32_t number = 1) {
    return deliver(MessageType::command, CancelExecution{attempt(number), "the run is aborted"}, "pioneer");
  }
  void journaled(std::uint32_t number = 1) {
    deliver(MessageType::information, OutcomeJournaled{attempt(number)}, "pioneer");
  }
  /// The robot has accepted `home` and reports that it is done.
  void finish() {
    take_fields();
    say("information\ndone\n\n4\nhome\n");
  }
};

Settings with_end(const SkillEnd& end) {
  Settings settings = pioneer();
  settings.description.skills[0].end = end;
  return settings;
}

constexpr const char* kToDock = R"({"place": "dock"})";
constexpr const char* kHomeJoints = R"({"joints": [0.5, 0.5, 0.5, 0.5, 0.5, 0.5]})";

}  // namespace

TEST_CASE("a skill: begun, done, told again every second until it is journaled") {
  SkillFixture fixture;
  const auto id = fixture.execute(order("go_to", kToDock));
  CHECK(fixture.answer(id) == "running");
  CHECK(fixture.take_fields() == "command\ngo_to\npioneer\n3\n1 2\n");
  fixture.wait(1.5);
  fixture.say("information\ndone\n\n11\ngo_to at 17\n");
  const auto outcome = fixture.one<Outcome>();
  CHECK(outcome.outcome == TaskOutcome::finished);
  CHECK(outcome.instance == kInstance);
  CHECK(outcome.data == "\"at 17\"");
  CHECK(outcome.duration_s == doctest::Approx(1.5));
  CHECK(fixture.counted("from_robot.done") == 1);
  fixture.wait(2.5);
  CHECK(fixture.told<Outcome>().size() == 2);
  fixture.journaled();
  fixture.wait(5);
  CHECK(fixture.told<Outcome>().empty());
  fixture.wait(10);  // its control lease
  CHECK_FALSE(fixture.core.next_deadline());
}

TEST_CASE("the same attempt twice is one attempt") {
  SkillFixture fixture;
  fixture.execute(order("home", ""));
  CHECK(fixture.answer(fixture.execute(order("home", ""))) == "running");
  fixture.finish();
  CHECK(fixture.counted("to_robot.home") == 5);
  CHECK(fixture.answer(fixture.execute(order("home", ""))) == "finished");
  fixture.journaled();
  CHECK(fixture.answer(fixture.execute(order("home", ""))) == "finished");
  CHECK(fixture.written().empty());
}

TEST_CASE("an order for an earlier start of the process, or from another node, is refused") {
  SkillFixture fixture;
  Execute stale = order("home", "");
  stale.instance = kInstance - 1;
  CHECK(fixture.answer(fixture.execute(stale)) == "nack stale_instance");
  CHECK(fixture.answer(fixture.deliver(MessageType::command, order("home", ""), "ur3")) == "nack not_permitted");
  CHECK(fixture.written().empty());
}

TEST_CASE("one skill at a time") {
  SkillFixture fixture;
  fixture.execute(order("home", ""));
  CHECK(fixture.answer(fixture.execute(order("home", "", 2))) == "nack busy");
  fixture.finish();
  CHECK(fixture.answer(fixture.execute(order("home", "", 2))) == "running");
}

TEST_CASE("a robot that is not connected is asked for nothing, and the attempt may be made again") {
  Fixture fixture(pioneer());
  CHECK(fixture.answer(fixture.deliver(MessageType::command, order("home", ""), "pioneer")) == "nack robot_offline");
  fixture.up(Channel::field);
  CHECK(fixture.answer(fixture.deliver(MessageType::command, order("home", ""), "pioneer")) == "running");
}

TEST_CASE("what can never succeed has failed at once, with the parameter's name") {
  SkillFixture fixture;
  CHECK(fixture.answer(fixture.execute(order("fly", ""))) == "failed");
  CHECK(fixture.answer(fixture.execute(order("go_to", "{}", 2))) == "failed");
  CHECK(fixture.answer(fixture.execute(order("go_to", R"({"place": "moon"})", 3))) == "failed");
  fixture.out.clear();
  fixture.wait(1);
  const auto told = fixture.told<Outcome>();
  REQUIRE(told.size() == 3);
  CHECK(get<Outcome>(told[0].body).reason.find("unknown_skill") != std::string::npos);
  CHECK(get<Outcome>(told[1].body).reason.find("'place'") != std::string::npos);
  CHECK(get<Outcome>(told[2].body).reason.find("'moon'") != std::string::npos);
}

TEST_CASE("a robot that says `failed` gives its reason; a `done` that comes late is counted and dropped") {
  SkillFixture fixture;
  fixture.execute(order("home", ""));
  fixture.say("information\ndone\n\n4\nhome\n");  // it has not even received it
  CHECK(fixture.told<Outcome>().empty());
  fixture.take_fields();
  fixture.say("information\nfailed\n\n12\nhome blocked\n");
  CHECK(fixture.failure() == "blocked");
  fixture.say("information\ndone\n\n4\nhome\n");
  CHECK(fixture.told<Outcome>().empty());
  CHECK(fixture.counted("refused.late_done") == 2);
}

TEST_CASE("a connection lost while a skill runs: nobody knows, so it is interrupted") {
  SkillFixture fixture;
  fixture.execute(order("home", ""));
  fixture.take_fields();
  fixture.down(Channel::field, "connection reset by peer");
  CHECK(fixture.one<Outcome>().outcome == TaskOutcome::interrupted);
}

TEST_CASE("time-out: the motion is stopped without a fence, and what is said of it after that counts for nothing") {
  SkillFixture fixture;
  Execute late = order("home", "");
  late.timeout_s = 2.5;
  fixture.execute(late);
  fixture.take_fields();
  fixture.wait(2.5);
  CHECK(fixture.written() == "!stop\n!release\n");
  CHECK(fixture.fence_writes.empty());
  CHECK(fixture.told<Outcome>().empty());
  CHECK(fixture.answer(fixture.execute(order("home", "", 2))) == "nack busy");  // not before the robot has stopped
  fixture.say("!stopped\n!released\n");
  CHECK(fixture.failure() == "timed out after 2.5 s");
  fixture.execute(order("home", "", 3));
  fixture.say("information\ndone\n\n4\nhome\n");
  CHECK(fixture.told<Outcome>().empty());
  CHECK(fixture.take_fields() == "command\nhome\npioneer\n0\n\n");
}

TEST_CASE("a `done` that comes before the robot confirms its halt: the skill has finished") {
  SkillFixture fixture;
  fixture.execute(order("home", ""));
  fixture.take_fields();
  fixture.cancel();
  fixture.say("information\ndone\n\n4\nhome\n!stopped\n!released\n");
  CHECK(fixture.one<Outcome>().outcome == TaskOutcome::finished);
}

TEST_CASE("cancelled while it runs, after it has ended, and before it was ever heard of") {
  SkillFixture fixture;
  fixture.execute(order("home", ""));
  fixture.take_fields();
  CHECK(fixture.answer(fixture.cancel()) == "running");
  CHECK(fixture.written() == "!stop\n!release\n");
  fixture.say("!stopped\n!released\n");
  CHECK(fixture.one<Outcome>().reason == "cancelled: the run is aborted");

  CHECK(fixture.answer(fixture.cancel(2)) == "failed");
  CHECK(fixture.answer(fixture.execute(order("home", "", 2))) == "failed");
  CHECK(fixture.written().empty());

  fixture.execute(order("home", "", 3));
  fixture.finish();
  CHECK(fixture.answer(fixture.cancel(3)) == "finished");
}

TEST_CASE("a cancelled skill that the robot has not begun to hear of is taken out of the queue, nothing is stopped") {
  SkillFixture fixture;
  fixture.send(MessageType::information, "news", "1");
  CHECK(fixture.answer(fixture.execute(order("home", ""))) == "running");
  fixture.cancel();
  CHECK(fixture.one<Outcome>().outcome == TaskOutcome::failed);  // at once
  CHECK(fixture.take_fields() == "information\nnews\noperator\n1\n1\n");
  CHECK(fixture.written().empty());
}

TEST_CASE("asked what became of an attempt") {
  SkillFixture fixture;
  CHECK(fixture.answer(fixture.query()) == "unknown");
  fixture.execute(order("home", ""));
  CHECK(fixture.answer(fixture.query()) == "running");
  fixture.finish();
  CHECK(fixture.answer(fixture.query()) == "finished");
}

TEST_CASE("256 outcomes that nobody journals are the most; journaled ones make room") {
  SkillFixture fixture;
  for (std::uint32_t i = 1; i <= 256; ++i) fixture.cancel(i);
  CHECK(fixture.answer(fixture.execute(order("home", "", 300))) == "nack busy");
  fixture.journaled(7);
  CHECK(fixture.answer(fixture.execute(order("home", "", 300))) == "running");
  CHECK(fixture.answer(fixture.query(7)) == "unknown");
  CHECK(fixture.answer(fixture.query(8)) == "failed");
}

TEST_CASE("the end is a state that the robot tells its node") {
  SkillFixture fixture(with_end({EndKind::state, "gripper", 2, 0, "", 0}));
  fixture.execute(order("go_to", kToDock));
  fixture.say("information\ngripper\n\n1\n2\n");  // before it has the command
  fixture.take_fields();
  fixture.say("information\ngripper\n\n1\n1\n");
  CHECK(fixture.told<Outcome>().empty());
  fixture.say("information\ngripper\n\n1\n2\n");
  CHECK(fixture.one<Outcome>().outcome == TaskOutcome::finished);
}

TEST_CASE("a robot that acknowledges nothing: a state that differs from the last one before the command is the end") {
  Settings settings = with_end({EndKind::state, "ready", 1, 0, "", 0});
  settings.description.field_channel.acknowledge = false;
  for (const bool again : {false, true}) {
    SkillFixture fixture(settings);
    fixture.say("information\nready\n\n1\n0\n");
    if (again) {  // what it was before the link was lost says nothing of a change
      fixture.down(Channel::field);
      fixture.up(Channel::field);
    }
    fixture.execute(order("go_to", kToDock));
    fixture.wait(0.8);
    fixture.say("information\nready\n\n1\n1\n");
    CHECK(fixture.told<Outcome>().size() == (again ? 0 : 1));
    fixture.wait(1.3);
    CHECK_FALSE(fixture.told<Outcome>().empty());
  }
}

TEST_CASE("the end is a position: the robot's frame and units, near enough") {
  Settings settings = with_end({EndKind::position, "", 0, 15, "place", 0});
  settings.description.frame.length = 1000;
  settings.description.frame.origin = {1, 1, 0, 0};
  SkillFixture fixture(settings);
  fixture.execute(order("go_to", kToDock));
  CHECK(fixture.take_fields() == "command\ngo_to\npioneer\n6\n0 1000\n");
  fixture.say("information\nposition\n\n5\n0 980\n");
  CHECK(fixture.told<Outcome>().empty());
  fixture.say("information\ndone\n\n5\ngo_to\n");  // it reports so, but it is not there
  CHECK(fixture.told<Outcome>().empty());
  fixture.say("information\nposition\n\n8\n10 990 0\n");
  CHECK(fixture.one<Outcome>().outcome == TaskOutcome::finished);
}

TEST_CASE("the end is a time, counted from when the robot has the command") {
  SkillFixture fixture(with_end({EndKind::time, "", 0, 0, "", 3}));
  fixture.execute(order("go_to", kToDock));
  fixture.wait(1);
  fixture.take_fields();
  fixture.wait(2.9);
  CHECK(fixture.told<Outcome>().empty());
  fixture.wait(0.1);
  CHECK(fixture.one<Outcome>().outcome == TaskOutcome::finished);
}

TEST_CASE("an arm's program that came to its end has finished, one that was cut short has failed") {
  for (const bool text_first : {true, false}) {
    UrFixture fixture;
    fixture.deliver(MessageType::command, order("reach", kHomeJoints), "ur3");
    fixture.monitor(ur_started("trb_77_1"));
    fixture.monitor(text_first ? ur_text("trb_77_1 done") : ur_stopped("trb_77_1"));
    CHECK(fixture.told<Outcome>().empty());
    fixture.monitor(text_first ? ur_stopped("trb_77_1") : ur_text("trb_77_1 done"));
    CHECK(fixture.one<Outcome>().outcome == TaskOutcome::finished);
  }
  UrFixture cut;
  cut.deliver(MessageType::command, order("reach", kHomeJoints), "ur3");
  cut.monitor(ur_started("trb_77_1") + ur_stopped("trb_77_0") + ur_stopped("trb_77_1"));
  cut.wait(0.2);
  const auto outcome = cut.one<Outcome>();
  CHECK(outcome.outcome == TaskOutcome::failed);
  CHECK(outcome.reason.find("before its end") != std::string::npos);
}

TEST_CASE("an arm that refuses a skill's program, or raises an exception in it, has failed it in its own words") {
  UrFixture refused;
  refused.deliver(MessageType::command, order("reach", kHomeJoints), "ur3");
  refused.monitor(ur_exception(1, 1, "runtime_error_robot_not_running:"));
  CHECK(refused.one<Outcome>().reason == "line 1, column 1: runtime_error_robot_not_running:");
  UrFixture raised;
  raised.deliver(MessageType::command, order("reach", kHomeJoints), "ur3");
  raised.monitor(ur_started("trb_77_1") + ur_exception(2, 3, "runtime_error_no_inverse:") + ur_stopped("trb_77_1"));
  CHECK(raised.one<Outcome>().reason == "line 2, column 3: runtime_error_no_inverse:");
}

TEST_CASE("a cancelled arm is told the vendor's stop, no fence is set") {
  UrFixture fixture;
  fixture.deliver(MessageType::command, order("reach", kHomeJoints), "ur3");
  fixture.monitor(ur_started("trb_77_1"));
  fixture.sent();
  fixture.deliver(MessageType::command, CancelExecution{attempt(), "no"}, "ur3");
  CHECK(fixture.sent() == "stop program\n");
  fixture.monitor(ur_stopped("trb_77_1"));
  fixture.wait(0.5);
  CHECK(fixture.one<Outcome>().outcome == TaskOutcome::failed);
  CHECK(fixture.fence_writes.empty());
}

TEST_CASE("an arm at its target: a state from before the command does not count") {
  Settings settings = ur3();
  settings.description.skills[0].end = {EndKind::position, "", 0, 0.01, "joints", 0};
  UrFixture fixture(settings);
  fixture.deliver(MessageType::command, order("reach", kHomeJoints), "ur3");
  fixture.monitor(ur_started("trb_77_1") + ur_state({.running = true}));
  CHECK(fixture.told<Outcome>().empty());
  fixture.live(0.2, {.running = true, .joint = 0.4});
  CHECK(fixture.told<Outcome>().empty());
  fixture.live(0.1, {.running = true, .joint = 0.495});
  CHECK(fixture.one<Outcome>().outcome == TaskOutcome::finished);
}

TEST_CASE("a skill whose end can never be heard is refused when it is asked for, not when it times out") {
  Settings settings = ur3();
  settings.commands.wrap.clear();
  UrFixture fixture(settings);
  CHECK(fixture.answer(fixture.deliver(MessageType::command, order("reach", kHomeJoints), "ur3")) == "failed");
  CHECK(fixture.sent().empty());
}
