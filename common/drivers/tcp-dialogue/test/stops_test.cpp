// What becomes of a halt, a stop and a release of a robot that answers in text: taken, refused, lost.
#include "common/drivers/tcp-dialogue/test/fixture.hpp"

using namespace trb;
using namespace trb::adapter;

TEST_CASE("dialogue: a stop waits for the one answer that is under way, and drops all that waits") {
  OnlineRover fixture;
  const auto first = fixture.command("tidy", "[1]");
  const auto second = fixture.command("tidy", "[2]");
  CHECK(fixture.asked() == "FOLD");
  const auto stop = fixture.deliver(MessageType::command, Stop{}, "operator");
  CHECK(fixture.answer(first) == "nack fenced");
  CHECK(fixture.answer(second) == "nack fenced");
  CHECK(fixture.asked().empty());
  fixture.reply("ERR 1");  // the command's: it refuses no stop
  CHECK(fixture.asked() == "HALT");
  CHECK(fixture.answer(stop).empty());
  fixture.reply("OK");
  fixture.wait(0.01);
  CHECK(fixture.answer(stop) == "ack stopped");
  const auto release = fixture.deliver(MessageType::command, Release{}, "operator");
  CHECK(fixture.serve() == "RESUME");
  CHECK(fixture.answer(release) == "ack released");
}

TEST_CASE("dialogue: a stop behind an answer that does not come is given again on the next connection") {
  OnlineRover fixture;
  fixture.command("tidy", "[1]");
  CHECK(fixture.asked() == "FOLD");
  fixture.deliver(MessageType::command, Stop{}, "operator");
  fixture.wait(1);
  CHECK(fixture.closed() == "no answer within 1 s to FOLD;");
  fixture.up(Channel::command);
  CHECK(fixture.asked() == "STATE");
  fixture.reply("81%, IDLE");
  CHECK(fixture.asked() == "WHERE");
  fixture.reply("AT 1 2");
  CHECK(fixture.asked() == "HALT");
}

TEST_CASE("dialogue: a robot that refuses to stop is a critical fault, and is told again each second") {
  OnlineRover fixture;
  const auto stop = fixture.deliver(MessageType::command, Stop{}, "operator");
  CHECK(fixture.asked() == "HALT");
  fixture.reply("ERR busy");
  fixture.wait(0.01);
  CHECK(fixture.nack_of(stop).what ==
        "the node is fenced, but the robot refused to stop: HALT was answered with: ERR busy");
  const RobotFault fault = fixture.one<RobotFault>();
  CHECK(fault.severity == Severity::critical);
  fixture.wait(1);
  for (std::string line = fixture.asked(); !line.empty() && line != "HALT"; line = fixture.asked())
    fixture.reply(fixture.polled(line));
  fixture.reply("OK");
  CHECK(get<RobotFault>(fixture.told<RobotFault>().back().body).ended);
}

TEST_CASE("dialogue: without good and bad an answer to a stop is no proof that the robot stands") {
  for (const bool judges : {false, true}) {
    Settings settings = rover();
    if (!judges) settings.commands.texts.clear();
    OnlineRover fixture(settings);
    const auto stop = fixture.deliver(MessageType::command, Stop{}, "operator");
    CHECK(fixture.asked() == "HALT");
    fixture.reply("OK");
    fixture.wait(0.01);
    CHECK(fixture.answer(stop) == "ack stopped");
    const auto is_ack = [&](const Send& send) { return send.reply_to == stop && holds_alternative<Ack>(send.body); };
    const auto ack = std::ranges::find_if(fixture.out.sends, is_ack);
    REQUIRE(ack != fixture.out.sends.end());
    CHECK(get<Ack>(ack->body).text.empty() == judges);
  }
}

TEST_CASE("dialogue: a skill that drives is halted by a stop that is held, then the release") {
  OnlineRover fixture;
  fixture.begin_drive();
  fixture.deliver(MessageType::command, CancelExecution{order("drive", "").key, "enough"}, "rover");
  CHECK(fixture.serve() == "HALT");
  CHECK(fixture.told<Outcome>().empty());
  fixture.wait(0.45);
  CHECK(fixture.serve().empty());
  fixture.wait(0.05);
  CHECK(fixture.serve() == "RESUME");
  CHECK(fixture.failure() == "cancelled: enough");
  fixture.reply("LOST the way");  // the end of a motion that nobody waits for any more
  CHECK(fixture.closed().empty());
}

TEST_CASE("dialogue: a skill whose robot is lost is interrupted, and halted when the robot is back") {
  OnlineRover fixture;
  fixture.begin_drive();
  fixture.down(Channel::command, "reset");
  CHECK(fixture.one<Outcome>().outcome == TaskOutcome::interrupted);
  fixture.up(Channel::command);
  CHECK(fixture.serve().starts_with("HALT"));
}

TEST_CASE("dialogue: a stop ends a skill that drives, and the end that the robot tells then confirms no stop") {
  OnlineRover fixture;
  fixture.begin_drive();
  const auto stop = fixture.deliver(MessageType::command, Stop{}, "operator");
  CHECK(fixture.asked() == "HALT");
  fixture.reply("LOST the way");
  fixture.wait(0.01);
  CHECK(fixture.answer(stop).empty());
  fixture.reply("OK");
  fixture.wait(0.01);
  CHECK(fixture.answer(stop) == "ack stopped");
  CHECK(fixture.one<Outcome>().outcome == TaskOutcome::interrupted);
  CHECK(fixture.closed().empty());
}
