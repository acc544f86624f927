// The direct mode for a RAPID server: moves that block, the faults that a service task beside them reports, and both
// connections.
#include "common/drivers/rapid/test/fixture.hpp"

using namespace trb;
using namespace trb::adapter;

TEST_CASE("a move is started once it is not refused at once, and ends with its answer") {
  RapidFixture fixture;
  const auto id = fixture.command("move", "[10, -20.5]");
  CHECK(fixture.sent() == "2 10 -20.5 #");
  CHECK(fixture.answer(id).empty());
  fixture.live(0.4);
  CHECK(fixture.answer(id) == "ack started");
  fixture.program("2 ");
  fixture.program("1#");
  CHECK(fixture.counted("from_robot.done") == 1);
}

TEST_CASE("what the robot refuses is told with its text") {
  RapidFixture fixture;
  const auto id = fixture.command("move", "[10, 200]");
  fixture.program("2 0 J2%20200%20is%20out%20of%20its%20range#");
  CHECK(fixture.nack_of(id).what == "the robot refuses it: J2 200 is out of its range");
  CHECK(fixture.nack_of(fixture.command("move", "[1]")).what == "the command takes 2 items, and the data has 1");
}

TEST_CASE("a text of more than 80 characters is refused, and one with a quote or a newline ends nothing") {
  RapidFixture fixture;
  const auto id = fixture.command("show", '"' + std::string(76, 'x') + '"');
  CHECK(fixture.nack_of(id).code == "too_large");
  CHECK(fixture.nack_of(id).what == "the request has 81 characters, and a RAPID string holds 80");
  fixture.command("show", R"("a\"\n# 91 #")");
  CHECK(fixture.sent() == "40 a%22%0A%23%2091%20%23 #");
}

TEST_CASE("a command of several requests: each waits for the answer of the one before") {
  RapidFixture fixture;
  fixture.command("pick", "[1, 2]");
  CHECK(fixture.sent() == "2 1 2 #");
  fixture.program("2 1#");
  CHECK(fixture.sent() == "20 1 #");
  fixture.program("20 1#");
  CHECK(fixture.counted("from_robot.done") == 1);
}

TEST_CASE("two commands at once: the second waits for the end of the first, or for its own deadline") {
  RapidFixture fixture;
  fixture.command("move", "[1, 1]");
  fixture.remaining_ms = 1000;
  const auto second = fixture.command("move", "[2, 2]");
  fixture.remaining_ms = 8000;
  const auto third = fixture.command("move", "[3, 3]");
  CHECK(fixture.sent() == "2 1 1 #");
  fixture.live(1.1);
  CHECK(fixture.answer(second) == "nack timeout");
  fixture.program("2 1#");
  CHECK(fixture.sent() == "2 3 3 #");
  fixture.live(0.4);
  CHECK(fixture.answer(third) == "ack started");
}

TEST_CASE("a skill ends with the answer of its move; meanwhile other commands are refused") {
  RapidFixture fixture;
  fixture.deliver(MessageType::request, order("home", ""), "abb");
  fixture.flags = kFlagTakeControl;
  CHECK(fixture.answer(fixture.command("move", "[1, 1]")) == "nack busy");
  fixture.live(3);
  fixture.program("2 0 joint%20error#");
  CHECK(fixture.one<Outcome>().reason == "joint error");
}

TEST_CASE("a fault: the service task's text, its capability and severity, told once") {
  RapidFixture fixture;
  fixture.deliver(MessageType::request, order("home", ""), "abb");
  fixture.state = "0 0 0 50204 grab%20URGENT%20arm%20%22hit%22";
  fixture.live(0.3);
  const auto fault = fixture.one<RobotFault>();
  CHECK(fault.capability == "grab");
  CHECK(fault.severity == Severity::urgent);
  CHECK(fault.text == "arm \"hit\"");
  fixture.live(1.2);
  // The program has not answered: its command must not go on when the motors are on again.
  CHECK(fixture.one<Outcome>().reason == "the robot's motors went off: grab URGENT arm \"hit\"");
  CHECK(fixture.turns == "91 #92 #");
  fixture.flags = kFlagTakeControl;
  CHECK(fixture.nack_of(fixture.command("move", "[1, 1]")).hint.find("panel") != std::string::npos);
  CHECK(fixture.told<RobotFault>().empty());
}

TEST_CASE("a fault ends with the service task's error, and motors that went off with the motors") {
  RapidFixture fixture;
  fixture.state = "0 0 0 0";
  fixture.live(0.3);
  REQUIRE(fixture.kept.size() == 1);
  fixture.state = "0 0 0 50204 grab%20CRITICAL%20gripper%20lost";
  fixture.live(0.3);
  CHECK(fixture.kept.size() == 2);
  fixture.state = "0 0 1 50204 grab%20CRITICAL%20gripper%20lost";
  fixture.live(0.3);
  REQUIRE(fixture.kept.size() == 1);
  CHECK(fixture.kept[0].what.text == "gripper lost");
  fixture.over();
  fixture.state = "0 0 1 0";
  fixture.live(0.3);
  CHECK(fixture.over() == std::vector<std::string>{"grab: gripper lost"});
}

TEST_CASE("a service task that is silent for 2 s: the robot is gone, and what was under way is told so") {
  RapidFixture fixture;
  fixture.deliver(MessageType::request, order("home", ""), "abb");
  fixture.live(0.5);
  fixture.wait(2.5);
  CHECK(fixture.closed().find("service task") != std::string::npos);
  CHECK(fixture.one<Outcome>().outcome == TaskOutcome::interrupted);
  fixture.flags = kFlagTakeControl;
  CHECK(fixture.answer(fixture.command("move", "[1, 1]")) == "nack robot_offline");
}

TEST_CASE("the robot is there once both of its tasks are, whichever comes last, and whichever was lost alone") {
  for (const Channel last : {Channel::command, Channel::monitor}) {
    for (const bool restarts : {false, true}) {
      CAPTURE(name_of(last));
      CAPTURE(restarts);
      RapidFixture fixture;
      fixture.welcome();
      fixture.told<AdapterState>();
      fixture.down(last);
      if (restarts) fixture.down(last == Channel::command ? Channel::monitor : Channel::command);
      CHECK(fixture.one<AdapterState>().robot == "CONNECTION_BROKEN");
      if (restarts) fixture.up(last == Channel::command ? Channel::monitor : Channel::command);
      fixture.live(0.5);
      CHECK(fixture.told<AdapterState>().empty());
      fixture.up(last);
      fixture.live(0.5);
      CHECK(fixture.one<AdapterState>().robot == "ONLINE");
      fixture.flags = kFlagTakeControl;
      const auto id = fixture.command("move", "[1, 1]");
      CHECK(fixture.sent() == "2 1 1 #");
      static_cast<void>(id);
    }
  }
}

TEST_CASE("an answer of another code: the two sides are out of step, and the connection is closed") {
  RapidFixture fixture;
  const auto id = fixture.command("move", "[1, 1]");
  fixture.program("4 1 2 3#");
  CHECK(fixture.closed().find("answered 4 to request 2") != std::string::npos);
  CHECK(fixture.answer(id) == "nack robot_offline");
  RapidFixture calm;
  calm.program("2 1#");
  CHECK(calm.counted("refused.unasked_answer") == 1);
}
