// What a robot that answers in text is asked and told, and what its answers mean.
#include "common/drivers/tcp-dialogue/test/fixture.hpp"

using namespace trb;
using namespace trb::adapter;

TEST_CASE("dialogue: values of one line are asked for together, in rounds, and answered as numbers and texts") {
  RoverFixture fixture;
  fixture.up(Channel::command);
  CHECK(fixture.robot() == "OFFLINE");
  CHECK(fixture.asked() == "STATE");
  fixture.reply("81%, IDLE");
  CHECK(fixture.robot() == "ONLINE");
  CHECK(fixture.asked() == "WHERE");
  fixture.reply("AT 1.5 -2");
  CHECK(fixture.asked().empty());
  CHECK(fixture.answer(fixture.send(MessageType::request, "position", "")) == "[1.5,-2]");
  CHECK(fixture.answer(fixture.send(MessageType::request, "battery", "")) == "81");
  CHECK(fixture.answer(fixture.send(MessageType::request, "mode", "")) == "\"IDLE\"");
  fixture.wait(0.4);
  CHECK(fixture.asked().empty());
  fixture.wait(0.1);
  CHECK(fixture.asked() == "STATE");
}

TEST_CASE("dialogue: a command's lines go one after the other, and it is answered when all are") {
  OnlineRover fixture;
  const auto id = fixture.command("tidy", R"(["left"])");
  CHECK(fixture.asked() == "FOLD");
  fixture.reply("OK");
  CHECK(fixture.asked() == "PARK left");
  CHECK(fixture.answer(id).empty());
  fixture.reply("OK parked");
  CHECK(fixture.answer(id) == "ack handed_over");
}

TEST_CASE("dialogue: what the robot refuses is told with its words, and the lines behind it are not sent") {
  for (const char* words : {"ERR 7", "WELL", "OKAY? ERR"}) {
    OnlineRover fixture;
    const auto id = fixture.command("tidy", R"(["left"])");
    fixture.asked();
    fixture.reply(words);
    const bool good = std::string_view(words).starts_with("OK");
    CHECK(fixture.asked() == (good ? "PARK left" : ""));
    if (good) continue;
    const Nack nack = fixture.nack_of(id);
    CHECK(nack.code == "robot_error");
    CHECK(nack.what == std::string("FOLD was answered with: ") + words);
    CHECK(nack.hint.find("\"good\" and \"bad\" in commands.json") != std::string::npos);
  }
}

TEST_CASE("dialogue: values whose answer is bad are not known, and why is told once for all of them") {
  OnlineRover fixture;
  fixture.wait(0.5);
  CHECK(fixture.asked() == "STATE");
  fixture.reply("ERR 3");
  CHECK(fixture.one<RobotFault>().text.starts_with("2 values (battery, mode): STATE was answered with: ERR 3"));
  CHECK(fixture.answer(fixture.send(MessageType::request, "battery", "")).starts_with("nack"));
}

TEST_CASE("dialogue: a value whose answer is not like its pattern is not known, and the others are") {
  OnlineRover fixture;
  fixture.wait(0.5);
  fixture.asked();
  fixture.reply("81%, IDLE");
  CHECK(fixture.asked() == "WHERE");
  fixture.reply("NOWHERE");
  CHECK(fixture.one<RobotFault>().text ==
        "position: WHERE was answered with: NOWHERE, which is not like AT {0} {1}; correct values.position in "
        "commands.json");
  CHECK(fixture.answer(fixture.send(MessageType::request, "position", "")).starts_with("nack"));
  CHECK(fixture.answer(fixture.send(MessageType::request, "battery", "")) == "81");
  CHECK(fixture.robot() == "ONLINE");
}

TEST_CASE("dialogue: data stays within its line") {
  OnlineRover fixture;
  for (const char* data : {R"(["a\nHALT"])", R"(["a\u0000"])", R"(["a\"b"])", R"(["a\\b"])", R"(["a'b"])"})
    CHECK(fixture.nack_of(fixture.command("tidy", data)).code == "not_escapable");
  for (const char* data : {"", "[[1]]", "[null]", "[]", "left"})
    CHECK(fixture.nack_of(fixture.command("tidy", data)).code == "bad_value");
  CHECK(fixture.asked().empty());
}

TEST_CASE("dialogue: a skill with an end of its own is over at that line, whatever is asked meanwhile") {
  for (const bool well : {true, false}) {
    OnlineRover fixture;
    fixture.begin_drive();
    fixture.live(2);
    CHECK(fixture.told<Outcome>().empty());
    fixture.wait(0.1);
    fixture.asked();
    fixture.reply(well ? "ARRIVED dock" : "LOST the way");  // perhaps before the answer to a poll
    const Outcome outcome = fixture.one<Outcome>();
    CHECK(outcome.outcome == (well ? TaskOutcome::finished : TaskOutcome::failed));
    if (!well) CHECK(outcome.reason == "LOST the way");
    CHECK(fixture.closed().empty());
  }
}

TEST_CASE("dialogue: a command that is over at once, or that is refused, waits for no later line") {
  OnlineRover fixture;
  fixture.deliver(MessageType::command, order("drive", R"({"where": "here"})"), "rover");
  CHECK(fixture.asked() == "DRIVE here");
  fixture.reply("ARRIVED here");
  CHECK(fixture.one<Outcome>().outcome == TaskOutcome::finished);
  fixture.deliver(MessageType::information, OutcomeJournaled{attempt()}, "rover");
  fixture.deliver(MessageType::command, order("drive", R"({"where": "x"})", 2), "rover");
  CHECK(fixture.asked() == "DRIVE x");
  fixture.reply("LOST before it began");
  CHECK(fixture.failure() == "DRIVE x was answered with: LOST before it began");
  fixture.reply("ARRIVED late");
  CHECK(fixture.closed().empty());
}

TEST_CASE("dialogue: without an end of its own a skill is over at its answer") {
  OnlineRover fixture;
  fixture.deliver(MessageType::command, order("fold", ""), "rover");
  CHECK(fixture.asked() == "FOLD ARM");
  CHECK(fixture.told<Outcome>().empty());
  fixture.reply("OK");
  CHECK(fixture.one<Outcome>().outcome == TaskOutcome::finished);
}

TEST_CASE("dialogue: answers may come in pieces, and with lines that the robot says by itself") {
  OnlineRover fixture;
  const auto id = fixture.command("tidy", R"([3])");
  CHECK(fixture.asked() == "FOLD");
  fixture.hear(Channel::command, "NOTE all is");
  fixture.hear(Channel::command, " well\nO");
  CHECK(fixture.asked().empty());
  fixture.hear(Channel::command, "K\r\nNOTE x\n\n");
  CHECK(fixture.asked() == "PARK 3");
  fixture.reply("OK");
  CHECK(fixture.answer(id) == "ack handed_over");
}

TEST_CASE("dialogue: no answer in time ends the connection, so that a late one counts for nothing") {
  OnlineRover fixture;
  const auto id = fixture.command("tidy", "[1]");
  const auto waiting = fixture.command("tidy", "[2]");
  CHECK(fixture.asked() == "FOLD");
  fixture.wait(1);
  CHECK(fixture.closed() == "no answer within 1 s to FOLD;");
  CHECK(fixture.robot() == "CONNECTION_BROKEN");
  CHECK(fixture.nack_of(id).what.find("nobody knows whether it was taken") != std::string::npos);
  CHECK(fixture.nack_of(waiting).what.find("before the command was sent") != std::string::npos);
  fixture.reply("OK");  // late: still in the shell's buffer
  CHECK(fixture.answer(fixture.command("fold", "")) == "nack robot_offline");
  fixture.connect();
  CHECK(fixture.robot() == "ONLINE");
}

TEST_CASE("dialogue: a line that nobody asked for, or an answer twice, ends the connection, and the cure is told") {
  for (const bool twice : {false, true}) {
    OnlineRover fixture;
    if (twice) {
      fixture.command("tidy", "[1]");
      CHECK(fixture.asked() == "FOLD");
    }
    fixture.hear(Channel::command, twice ? "OK\nOK\n" : "HELLO\n");
    CHECK(fixture.asked().empty());
    CHECK(fixture.closed().find("name it in \"ignore\"") != std::string::npos);
    CHECK(fixture.counted("refused.bad_packet") == 1);
    CHECK(fixture.robot() == "CONNECTION_BROKEN");
  }
}

TEST_CASE("dialogue: an answer over 64 KiB ends the connection") {
  OnlineRover fixture;
  fixture.command("fold", "");
  fixture.hear(Channel::command, std::string(65537, 'x'));
  CHECK(fixture.closed() == "an answer over 64 KiB, or without its end;");
}

TEST_CASE("dialogue: the robot hears something at least every keep_alive_s, and is lost if it does not answer") {
  Settings settings = rover();
  settings.commands.requests.clear();
  settings.commands.texts["keep_alive"] = {"PING"};
  settings.commands.numbers["keep_alive_s"] = 0.4;
  RoverFixture fixture(settings);
  fixture.up(Channel::command);
  CHECK(fixture.asked() == "PING");
  CHECK(fixture.robot() == "OFFLINE");
  fixture.reply("any answer");
  CHECK(fixture.robot() == "ONLINE");
  fixture.wait(0.3);
  fixture.command("fold", "");
  CHECK(fixture.asked() == "FOLD ARM");
  fixture.reply("OK");
  fixture.wait(0.35);
  CHECK(fixture.asked().empty());
  fixture.wait(0.05);
  CHECK(fixture.asked() == "PING");
  fixture.wait(1);
  CHECK(fixture.closed() == "no answer within 1 s to PING;");
  CHECK(fixture.robot() == "CONNECTION_BROKEN");
}
