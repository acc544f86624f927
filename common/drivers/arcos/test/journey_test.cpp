// A Pioneer's journeys: goto, its ends, and stops.
#include "common/drivers/arcos/test/fixture.hpp"

using namespace trb;
using namespace trb::adapter;

TEST_CASE("a skill's goto turns, drives, corrects itself and turns to the heading") {
  PioneerFixture fixture;
  fixture.connect();
  fixture.execute("dock");  // 1 m to the north of where the robot was switched on
  fixture.live(0.1);
  CHECK(fixture.order() == "HEAD 90");
  fixture.robot.heading = 90;
  fixture.live(0.4);
  CHECK(fixture.order() == "MOVE 1000");
  fixture.robot = {-80, 920, 90, 0};
  fixture.live(0.4);
  CHECK(fixture.order() == "HEAD 45");
  fixture.robot.heading = 45;
  fixture.live(0.4);
  CHECK(fixture.order() == "MOVE 113");
  fixture.robot = {5, 1003, 45, 0};
  fixture.live(0.4);
  CHECK(fixture.order() == "HEAD 90");
  CHECK(fixture.told<Outcome>().empty());
  fixture.robot.heading = 88.5;
  fixture.live(0.4);
  CHECK(fixture.one<Outcome>().outcome == TaskOutcome::finished);
}

TEST_CASE("a long way is driven in parts of 5 m") {
  PioneerFixture fixture;
  fixture.connect();
  CHECK(fixture.answer(fixture.command("go_to", "12000 0 0")) == "ack started");
  fixture.live(0.1);
  CHECK(fixture.order() == "MOVE 5000");
  fixture.robot.x = 5000;
  fixture.live(0.4);
  CHECK(fixture.order() == "MOVE 5000");
  fixture.robot.x = 10000;
  fixture.live(0.4);
  CHECK(fixture.order() == "MOVE 2000");
}

TEST_CASE("a robot that moves is waited for") {
  PioneerFixture fixture;
  fixture.connect();
  fixture.command("go_to", "2000 0 0");
  fixture.live(0.1);
  fixture.sent();
  for (fixture.robot = {0, 0, 0, 400}; fixture.robot.x < 2000; fixture.robot.x += 40) fixture.live(0.1);
  CHECK(fixture.order().empty());
}

TEST_CASE("a goto ends in failure on a stall, on motors that go off, and without any progress; the robot is stopped") {
  PioneerFixture fixture;
  fixture.connect();
  std::uint32_t number = 0;
  const auto start = [&] {
    fixture.robot = {};
    fixture.live(0.2);
    fixture.deliver(MessageType::command, adapter::order("go_to", R"({"place":"dock"})", ++number), "pioneer1");
    fixture.live(0.1);
    fixture.sent();
    fixture.told<Outcome>();
  };
  const auto end = [&] {
    const Outcome outcome = fixture.one<Outcome>();
    CHECK(outcome.outcome == TaskOutcome::failed);
    fixture.deliver(MessageType::information, OutcomeJournaled{outcome.key}, "pioneer1");
    return outcome.reason;
  };
  start();
  fixture.robot.stall = 0x0103;
  fixture.sip_now();
  CHECK(fixture.sent() == kStopPacket);
  CHECK(end() == "both wheels stalled; front bumper 1");
  start();
  fixture.robot.flags = 0;
  fixture.sip_now();
  CHECK(end() == "the motors are off");
  start();
  fixture.live(3.1);
  CHECK(end() == "no progress for 3 s: at 0, 0 mm, heading 0 degrees, 1000 mm from the goal");
  CHECK(fixture.sent().ends_with(kStopPacket));
}

TEST_CASE("with its motors off the robot takes no motion, and the answer says what to do") {
  PioneerFixture fixture;
  fixture.connect();
  fixture.robot.flags = 0x20;
  fixture.sip_now();
  fixture.sent();
  const auto id = fixture.command("go_to", "1 2 3");
  CHECK(fixture.answer(id) == "nack robot_error");
  CHECK(fixture.nack_of(id).what.ends_with("the motors are off; the STOP button is pressed"));
  CHECK(fixture.nack_of(id).hint.find("trb release pioneer1") != std::string::npos);
  CHECK(fixture.sent().empty());
  CHECK(fixture.answer(fixture.command("say", "help")) == "ack handed_over");
}

TEST_CASE("while a skill's goto is under way, motions are refused; a STOP ends it, and says by what") {
  PioneerFixture fixture;
  fixture.connect();
  fixture.execute("dock");
  fixture.live(0.2);
  fixture.flags = kFlagTakeControl;
  CHECK(fixture.answer(fixture.command("speed", "100")) == "nack busy");
  CHECK(fixture.answer(fixture.command("go_to", "1 2 3")) == "nack busy");
  CHECK(fixture.answer(fixture.command("say", "hello")) == "ack handed_over");
  CHECK(fixture.told<Outcome>().empty());
  CHECK(fixture.answer(fixture.command("halt", "")) == "ack handed_over");
  CHECK(fixture.one<Outcome>().reason == "the robot was given 'halt' meanwhile");
}

TEST_CASE("a person's second goto takes the place of the first") {
  PioneerFixture fixture;
  fixture.connect();
  CHECK(fixture.answer(fixture.command("go_to", "1000 0 0")) == "ack started");
  fixture.live(0.1);
  CHECK(fixture.order() == "MOVE 1000");
  CHECK(fixture.answer(fixture.command("go_to", "0 1000 0")) == "ack started");
  CHECK(fixture.sent() == kStopPacket);
  fixture.live(0.1);
  CHECK(fixture.order() == "HEAD 90");
}

TEST_CASE("a stop ends the journey and is confirmed once the robot stands; release switches the motors on") {
  PioneerFixture fixture;
  fixture.connect();
  fixture.execute("dock");
  fixture.robot.speed = 300;
  fixture.live(0.2);
  fixture.sent();
  const auto id = fixture.deliver(MessageType::command, Stop{"fire"});
  CHECK(fixture.sent() == kStopPacket);
  fixture.live(0.3);
  CHECK(fixture.answer(id).empty());
  fixture.robot.speed = 0;
  fixture.live(0.1);
  CHECK(fixture.answer(id) == "ack stopped");
  CHECK(fixture.one<Outcome>().outcome == TaskOutcome::interrupted);
  CHECK(fixture.answer(fixture.command("speed", "1")) == "nack fenced");
  CHECK(fixture.sent().empty());
  fixture.robot.flags = 0;
  const auto released = fixture.deliver(MessageType::command, Release{});
  CHECK(fixture.sent() == "fafb06043b0100053b");
  fixture.live(0.2);
  CHECK(fixture.answer(released).empty());
  fixture.robot.flags = 1;
  fixture.live(0.1);
  CHECK(fixture.answer(released) == "ack released");
}

TEST_CASE("a robot that vanishes on its way: nobody knows whether it arrives, and nothing of it goes on") {
  PioneerFixture fixture;
  fixture.connect();
  fixture.execute("dock");
  fixture.live(0.2);
  fixture.down(Channel::command, "closed by the robot");
  const Outcome outcome = fixture.one<Outcome>();
  CHECK(outcome.outcome == TaskOutcome::interrupted);
  CHECK(outcome.reason == "the robot's connection was lost: closed by the robot");
  fixture.connect();
  fixture.live(1);
  CHECK(fixture.order().empty());
}

TEST_CASE("a goto is halted once the wheels stand; if the robot falls silent before, it is halted when it is back") {
  for (const bool silent : {false, true}) {
    PioneerFixture fixture;
    fixture.connect();
    const Execute drive = adapter::order("go_to", R"({"place":"dock"})");
    fixture.deliver(MessageType::command, drive, "pioneer1");
    fixture.robot.speed = 300;
    fixture.live(0.2);
    fixture.deliver(MessageType::command, CancelExecution{drive.key, "enough"}, "pioneer1");
    fixture.live(0.3);
    CHECK(fixture.told<Outcome>().empty());
    if (silent) fixture.wait(3.1);
    fixture.robot.speed = 0;
    if (!silent) fixture.live(0.2);
    CHECK(fixture.one<Outcome>().outcome == (silent ? TaskOutcome::interrupted : TaskOutcome::failed));
    const auto before = fixture.counted("to_robot.stop");
    if (silent) fixture.connect();
    CHECK(fixture.counted("to_robot.stop") == before + (silent ? 1 : 0));
  }
}
