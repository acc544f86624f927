// What becomes of a message to a KUKA that is halted: taken or not, confirmed, lost.
#include "common/drivers/c3/test/fixture.hpp"

using namespace trb;
using namespace trb::adapter;

TEST_CASE("a skill that takes too long: the motion is ended, and what the robot says afterwards is late") {
  C3Fixture fixture;
  fixture.begin_home();
  fixture.writes();
  fixture.live(10);
  CHECK(fixture.writes() == "TRB_STOP=TRUE\n");
  CHECK(fixture.told<Outcome>().empty());
  fixture.robot["TRB_STOPPED"] = "TRUE";
  fixture.finish(2, "stopped");
  CHECK(fixture.one<Outcome>().reason == "timed out after 10 s");
  CHECK(fixture.counted("refused.late_done") == 1);
  CHECK(fixture.robot["TRB_STOP"] == "FALSE");
  fixture.robot["TRB_STOPPED"] = "FALSE";
  fixture.live(0.1);
  fixture.flags = kFlagTakeControl;
  CHECK(fixture.take_command() == "ack started");
}

TEST_CASE("a message that came to its end before the robot has confirmed its halt has finished") {
  C3Fixture fixture;
  fixture.begin_home();
  fixture.cancel();
  fixture.finish();
  CHECK(fixture.one<Outcome>().outcome == TaskOutcome::finished);
}

TEST_CASE("a halt that waits for a release leaves the message its end") {
  C3Fixture fixture;
  fixture.begin_home();
  fixture.robot["TRB_STOPPED"] = "TRUE";
  fixture.deliver(MessageType::command, Release{}, "operator");
  fixture.cancel();
  fixture.finish();
  CHECK(fixture.one<Outcome>().outcome == TaskOutcome::finished);
}

TEST_CASE("a message that the program has just taken is halted, too") {
  C3Fixture fixture;
  fixture.deliver(MessageType::request, order("home", ""), "kuka");
  fixture.live(0.1);
  fixture.robot["TRB_COMMAND"] = "FALSE";  // and nobody has read it yet
  fixture.writes();
  fixture.cancel();
  fixture.live(0.1);
  CHECK(fixture.writes().find("TRB_STOP=TRUE") != std::string::npos);
  CHECK(fixture.told<Outcome>().empty());
  fixture.robot["TRB_STOPPED"] = "TRUE";
  fixture.live(0.1);
  CHECK(fixture.one<Outcome>().outcome == TaskOutcome::failed);
}

TEST_CASE("a halt that the robot refuses: the message goes on, and the next one waits for its end") {
  C3Fixture fixture;
  fixture.begin_home();
  fixture.robot.erase("TRB_STOP");
  fixture.cancel();
  fixture.live(0.1);
  CHECK(fixture.one<Outcome>().outcome == TaskOutcome::interrupted);
  CHECK(fixture.told<RobotFault>().size() == 2);  // a capability each
  CHECK(fixture.kept.size() == 1);
  fixture.writes();
  fixture.flags = kFlagTakeControl;
  CHECK(fixture.answer(fixture.command("wave", "1")) == "nack busy");
  fixture.live(0.1);
  CHECK(fixture.writes().empty());
  fixture.finish();
  fixture.writes();
  CHECK(fixture.take_command() == "ack started");
}

TEST_CASE("a halt that is lost with the connection is written again before all else") {
  C3Fixture fixture;
  fixture.begin_home();
  fixture.cancel();
  fixture.wait(2.1);
  CHECK(fixture.one<Outcome>().outcome == TaskOutcome::interrupted);
  fixture.written(Channel::command);
  fixture.writes();
  fixture.robot["TRB_STOP"] = "FALSE";
  fixture.up(Channel::command);
  fixture.live(0.1);
  CHECK(fixture.robot["TRB_STOP"] == "TRUE");
  CHECK(fixture.answer(fixture.deliver(MessageType::request, order("home", "", 2), "kuka")) == "nack busy");
  fixture.robot["TRB_STOPPED"] = "TRUE";
  fixture.live(0.1);
  CHECK(fixture.robot["TRB_STOP"] == "FALSE");
  CHECK(fixture.answer(fixture.deliver(MessageType::request, order("home", "", 2), "kuka")) == "running");
}

TEST_CASE(
    "a halt in whose place came a stop, and neither was confirmed: it is written behind the release of that stop") {
  C3Fixture fixture;
  fixture.begin_home();
  fixture.cancel();
  fixture.live(0.1);
  fixture.deliver(MessageType::command, Stop{"fire"});
  fixture.live(0.1);
  CHECK(fixture.one<Outcome>().outcome == TaskOutcome::interrupted);
  fixture.down(Channel::command, "gone");
  fixture.deliver(MessageType::command, Release{"all clear"});
  fixture.written(Channel::command);
  fixture.writes();
  fixture.up(Channel::command);
  const auto execute = [&] { return fixture.deliver(MessageType::request, order("home", "", 2), "kuka"); };
  fixture.live(0.1);
  CHECK(fixture.answer(execute()) == "nack busy");
  fixture.live(0.1);
  CHECK(fixture.writes().find("TRB_STOP=FALSE\nTRB_STOP=TRUE\n") != std::string::npos);
  CHECK(fixture.answer(execute()) == "nack busy");
  fixture.robot["TRB_STOPPED"] = "TRUE";
  fixture.live(0.1);
  CHECK(fixture.robot["TRB_STOP"] == "FALSE");
  CHECK(fixture.answer(execute()) == "running");
}
