// A Pioneer on its way: goto, its ends, and stops.
#include "common/drivers/arcos/test/bench.hpp"

using namespace trb;
using namespace trb::adapter;

TEST_CASE("a skill's goto turns, drives, corrects itself and turns to the heading") {
  PioneerBench bench;
  bench.connect();
  bench.execute("dock");  // 1 m to the north of where the robot was switched on
  bench.live(0.1);
  CHECK(bench.order() == "HEAD 90");
  bench.robot.heading = 90;
  bench.live(0.4);
  CHECK(bench.order() == "MOVE 1000");
  bench.robot = {-80, 920, 90, 0};
  bench.live(0.4);
  CHECK(bench.order() == "HEAD 45");
  bench.robot.heading = 45;
  bench.live(0.4);
  CHECK(bench.order() == "MOVE 113");
  bench.robot = {5, 1003, 45, 0};
  bench.live(0.4);
  CHECK(bench.order() == "HEAD 90");
  CHECK(bench.told<Outcome>().empty());
  bench.robot.heading = 88.5;
  bench.live(0.4);
  CHECK(bench.one<Outcome>().outcome == TaskOutcome::finished);
}

TEST_CASE("a long way is driven in parts of 5 m") {
  PioneerBench bench;
  bench.connect();
  CHECK(bench.answer(bench.command("go_to", "12000 0 0")) == "ack started");
  bench.live(0.1);
  CHECK(bench.order() == "MOVE 5000");
  bench.robot.x = 5000;
  bench.live(0.4);
  CHECK(bench.order() == "MOVE 5000");
  bench.robot.x = 10000;
  bench.live(0.4);
  CHECK(bench.order() == "MOVE 2000");
}

TEST_CASE("a robot that moves is waited for") {
  PioneerBench bench;
  bench.connect();
  bench.command("go_to", "2000 0 0");
  bench.live(0.1);
  bench.sent();
  for (bench.robot = {0, 0, 0, 400}; bench.robot.x < 2000; bench.robot.x += 40) bench.live(0.1);
  CHECK(bench.order().empty());
}

TEST_CASE("a goto ends in failure on a stall, on motors that go off, and without any progress; the robot is stopped") {
  PioneerBench bench;
  bench.connect();
  std::uint32_t number = 0;
  const auto start = [&] {
    bench.robot = {};
    bench.live(0.2);
    bench.deliver(MessageType::command, adapter::order("go_to", R"({"place":"dock"})", ++number), "pioneer1");
    bench.live(0.1);
    bench.sent();
    bench.told<Outcome>();
  };
  const auto end = [&] {
    const Outcome outcome = bench.one<Outcome>();
    CHECK(outcome.outcome == TaskOutcome::failed);
    bench.deliver(MessageType::information, OutcomeJournaled{outcome.key}, "pioneer1");
    return outcome.reason;
  };
  start();
  bench.robot.stall = 0x0103;
  bench.sip_now();
  CHECK(bench.sent() == kStopPacket);
  CHECK(end() == "both wheels stalled; front bumper 1");
  start();
  bench.robot.flags = 0;
  bench.sip_now();
  CHECK(end() == "the motors are off");
  start();
  bench.live(3.1);
  CHECK(end() == "no progress for 3 s: at 0, 0 mm, heading 0 degrees, 1000 mm from the goal");
  CHECK(bench.sent().ends_with(kStopPacket));
}

TEST_CASE("with its motors off the robot takes no motion, and the answer says what to do") {
  PioneerBench bench;
  bench.connect();
  bench.robot.flags = 0x20;
  bench.sip_now();
  bench.sent();
  const auto id = bench.command("go_to", "1 2 3");
  CHECK(bench.answer(id) == "nack robot_error");
  CHECK(bench.nack_of(id).what.ends_with("the motors are off; the STOP button is pressed"));
  CHECK(bench.nack_of(id).cure.find("trb release pioneer1") != std::string::npos);
  CHECK(bench.sent().empty());
  CHECK(bench.answer(bench.command("say", "help")) == "ack handed_over");
}

TEST_CASE("while a skill's goto is under way, motions are refused; a STOP ends it, and says by what") {
  PioneerBench bench;
  bench.connect();
  bench.execute("dock");
  bench.live(0.2);
  bench.flags = kFlagTakeControl;
  CHECK(bench.answer(bench.command("speed", "100")) == "nack busy");
  CHECK(bench.answer(bench.command("go_to", "1 2 3")) == "nack busy");
  CHECK(bench.answer(bench.command("say", "hello")) == "ack handed_over");
  CHECK(bench.told<Outcome>().empty());
  CHECK(bench.answer(bench.command("halt", "")) == "ack handed_over");
  CHECK(bench.one<Outcome>().reason == "the robot was given 'halt' meanwhile");
}

TEST_CASE("a person's second goto takes the place of the first") {
  PioneerBench bench;
  bench.connect();
  CHECK(bench.answer(bench.command("go_to", "1000 0 0")) == "ack started");
  bench.live(0.1);
  CHECK(bench.order() == "MOVE 1000");
  CHECK(bench.answer(bench.command("go_to", "0 1000 0")) == "ack started");
  CHECK(bench.sent() == kStopPacket);
  bench.live(0.1);
  CHECK(bench.order() == "HEAD 90");
}

TEST_CASE("a stop ends the journey and is confirmed once the robot stands; release switches the motors on") {
  PioneerBench bench;
  bench.connect();
  bench.execute("dock");
  bench.robot.speed = 300;
  bench.live(0.2);
  bench.sent();
  const auto id = bench.deliver(MessageType::command, Stop{"fire"});
  CHECK(bench.sent() == kStopPacket);
  bench.live(0.3);
  CHECK(bench.answer(id).empty());
  bench.robot.speed = 0;
  bench.live(0.1);
  CHECK(bench.answer(id) == "ack stopped");
  CHECK(bench.one<Outcome>().outcome == TaskOutcome::interrupted);
  CHECK(bench.answer(bench.command("speed", "1")) == "nack fenced");
  CHECK(bench.sent().empty());
  bench.robot.flags = 0;
  const auto released = bench.deliver(MessageType::command, Release{});
  CHECK(bench.sent() == "fafb06043b0100053b");
  bench.live(0.2);
  CHECK(bench.answer(released).empty());
  bench.robot.flags = 1;
  bench.live(0.1);
  CHECK(bench.answer(released) == "ack released");
}

TEST_CASE("a robot that vanishes on its way: nobody knows whether it arrives, and nothing of it goes on") {
  PioneerBench bench;
  bench.connect();
  bench.execute("dock");
  bench.live(0.2);
  bench.down(Channel::command, "closed by the robot");
  const Outcome outcome = bench.one<Outcome>();
  CHECK(outcome.outcome == TaskOutcome::interrupted);
  CHECK(outcome.reason == "the robot's connection was lost: closed by the robot");
  bench.connect();
  bench.live(1);
  CHECK(bench.order().empty());
}
