// A skill that is cancelled or times out: it is over once the robot is known to have the halt.
#include "services/mode-adapter/test/fixture.hpp"

using namespace trb;
using namespace trb::adapter;

namespace {

constexpr const char* kHomeJoints = R"({"joints": [0.5, 0.5, 0.5, 0.5, 0.5, 0.5]})";
constexpr const char* kToDock = R"({"place": "dock"})";
const std::string kMovej = "def trb_";

/// An arm under way; `link` is the cable between it and its node.
class ArmFixture : public UrFixture {
 public:
  explicit ArmFixture(Settings settings = ur3()) : UrFixture(std::move(settings)) {}

  std::uint64_t execute(std::uint32_t number = 1, double timeout_s = 0) {
    Execute skill = order("reach", kHomeJoints, number);
    skill.timeout_s = timeout_s;
    return deliver(MessageType::command, skill, "ur3");
  }
  void begin(double timeout_s = 0) {
    execute(1, timeout_s);
    monitor(ur_started("trb_77_1"));
    sent();
    live(0.5, {.running = true});
  }
  std::uint64_t cancel() {
    return deliver(MessageType::command, CancelExecution{attempt(), "the task is another robot's"}, "ur3");
  }
  /// The shell dials both of its ports again, and the monitor tells its state.
  void link_returns(const UrPicture& picture) {
    down(Channel::command, "connection timed out");
    up(Channel::command);
    up(Channel::monitor);
    state(picture);
  }
};

class FieldsFixture : public Fixture {
 public:
  explicit FieldsFixture(Settings settings = pioneer()) : Fixture(std::move(settings)) { up(Channel::field); }
  void begin(const std::string& skill = "home", const std::string& data = "") {
    deliver(MessageType::command, order(skill, data), "pioneer");
    take_fields();
  }
  std::uint64_t cancel() { return deliver(MessageType::command, CancelExecution{attempt(), "enough"}, "pioneer"); }
  std::uint64_t execute(std::uint32_t number) {
    return deliver(MessageType::command, order("home", "", number), "pioneer");
  }
};

}  // namespace

TEST_CASE("a time-out while the cable is out: nobody knows, and the robot is halted before all else when it is back") {
  ArmFixture fixture;
  fixture.begin(1);
  fixture.wait(0.5);  // the cable is out: no state comes any more
  CHECK(fixture.sent() == "stop program\n");
  CHECK(fixture.told<Outcome>().empty());  // it may never have left this computer
  fixture.wait(3);
  const auto outcome = fixture.one<Outcome>();
  CHECK(outcome.outcome == TaskOutcome::interrupted);
  CHECK(outcome.reason.starts_with("timed out after 1 s, and nobody knows whether the robot was halted"));

  fixture.link_returns({.running = true});
  CHECK(fixture.sent() == "stop program\n");
  CHECK(fixture.answer(fixture.execute(2)) == "nack busy");
  fixture.live(0.3, {.running = true});
  CHECK(fixture.answer(fixture.execute(2)) == "nack busy");
  fixture.live(0.1);
  CHECK(fixture.answer(fixture.execute(2)) == "running");
  CHECK(fixture.sent().starts_with(kMovej));
}

TEST_CASE("a cancel while the cable is out is no other: what the scheduler hears meanwhile is that it runs") {
  ArmFixture fixture;
  fixture.begin();
  CHECK(fixture.answer(fixture.cancel()) == "running");
  fixture.wait(1);
  CHECK(fixture.answer(fixture.cancel()) == "running");
  CHECK(fixture.sent() == "stop program\n");  // once
  fixture.down(Channel::command, "no route to host");
  CHECK(fixture.one<Outcome>().outcome == TaskOutcome::interrupted);
  CHECK(fixture.answer(fixture.cancel()) == "interrupted");
}

TEST_CASE("an arm that is seen to stand has been halted") {
  ArmFixture fixture;
  fixture.begin();
  fixture.cancel();
  fixture.live(0.2, {.running = true});
  fixture.live(0.1);
  CHECK(fixture.failure() == "cancelled: the task is another robot's");
}

TEST_CASE("an arm that came to its end before the halt reached it has done its task") {
  ArmFixture fixture;
  fixture.begin();
  fixture.cancel();
  fixture.wait(2);  // the link is slow
  fixture.monitor(ur_text("trb_77_1 done") + ur_stopped("trb_77_1"));
  fixture.live(0.5);
  CHECK(fixture.one<Outcome>().outcome == TaskOutcome::finished);
}

TEST_CASE("an arm whose program the halt cuts short has failed, for the reason of the halt") {
  ArmFixture fixture;
  fixture.begin();
  fixture.cancel();
  fixture.monitor(ur_stopped("trb_77_1"));
  fixture.wait(0.25);
  CHECK(fixture.one<Outcome>().reason == "cancelled: the task is another robot's");
}

TEST_CASE("a robot that is heard for as long as a lost link would take to show has the halt, whatever it still does") {
  ArmFixture fixture;
  fixture.begin();
  fixture.cancel();
  fixture.live(6.8, {.running = true});
  CHECK(fixture.told<Outcome>().empty());
  fixture.live(0.3, {.running = true});
  CHECK(fixture.one<Outcome>().outcome == TaskOutcome::failed);
}

TEST_CASE("a link that is lost again before the halt is confirmed: it is given once more") {
  ArmFixture fixture;
  fixture.begin();
  fixture.cancel();
  for (int i = 0; i < 3; ++i) {
    CHECK(fixture.sent() == "stop program\n");
    fixture.wait(3.1);
    fixture.link_returns({.running = true});
  }
  CHECK(fixture.sent() == "stop program\n");
  fixture.told<Outcome>();
  fixture.live(0.5);
  fixture.wait(3.1);
  fixture.link_returns({});
  CHECK(fixture.sent().empty());  // it was halted by then
}

TEST_CASE("a position that is reached while the robot is halted is the end; a state may come of the halt itself") {
  for (const bool position : {true, false}) {
    Settings settings = pioneer();
    settings.description.skills[0].end =
        position ? SkillEnd{EndKind::position, "", 0, 0.1, "place", 0} : SkillEnd{EndKind::state, "idle", 1, 0, "", 0};
    FieldsFixture fixture(std::move(settings));
    fixture.begin("go_to", kToDock);
    fixture.cancel();
    CHECK(fixture.written() == "!stop\n!release\n");
    fixture.say(position ? "information\nposition\n\n7\n1 2 0.0\n" : "information\nidle\n\n1\n1\n");
    fixture.say("!stopped\n!released\n");
    CHECK(fixture.one<Outcome>().outcome == (position ? TaskOutcome::finished : TaskOutcome::failed));
  }
}

TEST_CASE("a robot that acknowledges the halt is free at once") {
  FieldsFixture fixture;
  fixture.begin();
  CHECK(fixture.answer(fixture.cancel()) == "running");
  CHECK(fixture.written() == "!stop\n!release\n");
  CHECK(fixture.answer(fixture.execute(2)) == "nack busy");
  fixture.say("!stopped\n");
  CHECK(fixture.one<Outcome>().outcome == TaskOutcome::failed);
  CHECK(fixture.answer(fixture.execute(2)) == "running");
}

TEST_CASE("a robot that does not acknowledge the halt: its connection is closed, and it is halted on the next one") {
  FieldsFixture fixture;
  fixture.begin();
  fixture.cancel();
  fixture.written();
  fixture.wait(30);
  CHECK(fixture.closed() == "ack_timeout;");
  const auto told = fixture.told<Outcome>();
  REQUIRE_FALSE(told.empty());
  CHECK(get<Outcome>(told[0].body).outcome == TaskOutcome::interrupted);
  fixture.up(Channel::field);
  CHECK(fixture.written().find("!stop\n") != std::string::npos);
  CHECK(fixture.answer(fixture.execute(2)) == "nack busy");
  fixture.say("!released\n!stopped\n!released\n");
  CHECK(fixture.answer(fixture.execute(2)) == "running");
}

TEST_CASE("a robot whose link is lost while a skill runs may go on: it is halted before anything else begins") {
  ArmFixture fixture;
  fixture.begin();
  fixture.down(Channel::monitor, "connection timed out");
  CHECK(fixture.one<Outcome>().outcome == TaskOutcome::interrupted);
  fixture.link_returns({.running = true});
  CHECK(fixture.sent() == "stop program\n");
  CHECK(fixture.answer(fixture.execute(2)) == "nack busy");
  fixture.live(0.4);
  CHECK(fixture.answer(fixture.execute(2)) == "running");
}

TEST_CASE("what an earlier process had begun is halted before anything else begins") {
  FieldsFixture fixture;
  const CancelExecution order{attempt(), "begun by an earlier process of the mode-adapter", "home"};
  fixture.deliver(MessageType::command, order, "pioneer");
  CHECK_FALSE(fixture.told<Outcome>().empty());
  CHECK(fixture.written() == "!stop\n!release\n");
  CHECK(fixture.answer(fixture.execute(2)) == "nack busy");
  fixture.deliver(MessageType::command, order, "pioneer");
  CHECK(fixture.written().empty());
  fixture.say("!stopped\n");
  CHECK(fixture.answer(fixture.execute(2)) == "running");
}

TEST_CASE("what an earlier process had begun is halted once the robot is there, and by no halt while it is fenced") {
  ArmFixture fixture;
  SUBCASE("it comes later") {
    fixture.down(Channel::command, "connection timed out");
    fixture.down(Channel::monitor, "connection timed out");
    fixture.deliver(MessageType::command, CancelExecution{attempt(), "before", "reach"}, "ur3");
    CHECK(fixture.sent().empty());
    fixture.up(Channel::command);
    fixture.up(Channel::monitor);
    fixture.state({.running = true});
    CHECK(fixture.sent() == "stop program\n");
    CHECK(fixture.answer(fixture.execute(2)) == "nack busy");
  }
  SUBCASE("it is fenced") {
    fixture.deliver(MessageType::command, Stop{}, "cloud");
    fixture.sent();
    fixture.deliver(MessageType::command, CancelExecution{attempt(), "before", "reach"}, "ur3");
    CHECK(fixture.sent().empty());
  }
}

TEST_CASE("what the robot may have whole, and has not acknowledged, is halted like what it carries out") {
  FieldsFixture fixture;
  fixture.deliver(MessageType::command, order("home", ""), "pioneer");
  fixture.take_fields(4);
  fixture.cancel();
  CHECK(fixture.told<Outcome>().empty());
  fixture.down(Channel::field, "connection reset by peer");
  CHECK(fixture.one<Outcome>().outcome == TaskOutcome::interrupted);
}

TEST_CASE("a stop while the robot is halted takes the halt's place") {
  FieldsFixture fixture;
  fixture.begin();
  fixture.cancel();
  fixture.written();
  fixture.deliver(MessageType::command, Stop{"a person is in the way"});
  CHECK(fixture.one<Outcome>().outcome == TaskOutcome::interrupted);
  CHECK(fixture.written() == "!stop\n");
  fixture.say("!stopped\n!released\n!stopped\n");
  fixture.down(Channel::field, "gone");
  fixture.deliver(MessageType::command, Release{"all clear"});
  fixture.up(Channel::field);
  CHECK(fixture.written() == "!release\n");  // nothing is owed any more
}

TEST_CASE("a robot that is stopped when it comes back is not released by the halt that it is owed") {
  FieldsFixture fixture;
  fixture.begin();
  fixture.cancel();
  fixture.written();
  fixture.down(Channel::field, "gone");
  fixture.deliver(MessageType::command, Stop{"a person is in the way"});
  fixture.up(Channel::field);
  CHECK(fixture.written() == "!stop\n");
}

TEST_CASE("a skill that a fault ends is halted like any other") {
  ArmFixture fixture;
  fixture.begin();
  fixture.cancel();
  fixture.live(0.1, {.running = true, .protective = true});
  CHECK(fixture.failure() == "cancelled: the task is another robot's");  // its program has ended
}

TEST_CASE("while it is halted the process has work, and the robot is busy for a drive and for a run") {
  FieldsFixture fixture;
  fixture.begin();
  fixture.cancel();
  CHECK_FALSE(fixture.may_be_replaced());
  fixture.say("!stopped\n!released\n");
  fixture.deliver(MessageType::information, OutcomeJournaled{attempt()}, "pioneer");
  CHECK_FALSE(fixture.may_be_replaced());
  fixture.wait(3);
  CHECK(fixture.may_be_replaced());
}
