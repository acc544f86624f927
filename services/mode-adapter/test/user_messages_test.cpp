// The users' own messages by themselves: each command and request has one answer.
#include "services/mode-adapter/core/user_messages.hpp"

#include "services/mode-adapter/test/fixture.hpp"

using namespace trb;
using namespace trb::adapter;

namespace {

class UserMessagesFixture {
 public:
  explicit UserMessagesFixture(bool connected = true) {
    if (connected) robot.field().on_up(Channel::field, now, robot.to(robot.field(), out));
  }
  /// The token by which the robot's driver knows it.
  Token send(MessageType type, const std::string& subtype, std::uint64_t id, std::uint32_t remaining_ms = 1000,
             const std::string& source = "operator") {
    messages.on_message({type, source, "pioneer", id, 0, 0, remaining_ms, Opaque{subtype, "1"}}, Opaque{subtype, "1"},
                        now, out);
    return ++last_;
  }
  /// The answer to that message since the last call: "ack STATE", "nack CODE" or the data.
  std::string answer(std::uint64_t id) {
    std::string all;
    for (const Send& sent : out.sends) {
      if (sent.reply_to != id) continue;
      if (const auto* ack = get_if<Ack>(&sent.body)) all += "ack " + ack->state;
      if (const auto* nack = get_if<Nack>(&sent.body)) all += "nack " + nack->code;
      if (const auto* said = get_if<Opaque>(&sent.body)) all += said->data;
    }
    std::erase_if(out.sends, [&](const Send& sent) { return sent.reply_to == id; });
    return all;
  }

  Now now{MonotonicTime{} + seconds(100), UtcTime{}};
  Outbox out;
  RobotSide robot{pioneer()};
  StopControl stops{robot, [](bool) { return Status(Done{}); }};
  RobotControl control{stops, "pioneer"};
  UserMessages messages{robot, control};

 private:
  Token last_ = 0;
};

}  // namespace

TEST_CASE("a command is answered once the robot has it, and its sender commands the robot") {
  UserMessagesFixture fixture;
  const Token token = fixture.send(MessageType::command, "move", 7);
  CHECK(fixture.answer(7).empty());
  CHECK(fixture.control.holder()->name == "operator");
  fixture.messages.on_progress(token, "handed_over", fixture.out);
  CHECK(fixture.answer(7) == "ack handed_over");
  fixture.messages.on_progress(token, "started", fixture.out);
  CHECK(fixture.answer(7).empty());
}

TEST_CASE("what the robot refuses is refused to the sender, once") {
  UserMessagesFixture fixture;
  const Token token = fixture.send(MessageType::command, "move", 7);
  fixture.messages.on_refused({token, fail(Errc::robot_error, "no")}, fixture.out);
  CHECK(fixture.answer(7) == "nack robot_error");
  fixture.messages.on_refused({token, fail(Errc::robot_error, "no")}, fixture.out);
  CHECK(fixture.answer(7).empty());
}

TEST_CASE("a request is answered with the next that the robot says of it to its requester; the rest is information") {
  UserMessagesFixture fixture;
  fixture.send(MessageType::request, "position", 7);
  const Said said{MessageType::information, "position", "operator", "[1,2]"};
  fixture.messages.on_said({MessageType::information, "position", "cloud", "[0,0]"}, fixture.out);
  CHECK(fixture.answer(7).empty());
  fixture.messages.on_said(said, fixture.out);
  CHECK(fixture.answer(7) == "[1,2]");
  fixture.out.sends.clear();
  fixture.messages.on_said(said, fixture.out);
  REQUIRE(fixture.out.sends.size() == 1);
  CHECK(fixture.out.sends[0].type == MessageType::information);
  CHECK(fixture.out.sends[0].reply_to == 0);
}

TEST_CASE("a node that asks without end keeps nobody else from asking") {
  UserMessagesFixture fixture;
  for (std::uint64_t id = 100; id < 164; ++id) {
    fixture.send(MessageType::request, "position", id, 5000, "thief");
    CHECK(fixture.answer(id).empty());
  }
  fixture.send(MessageType::request, "position", 164, 5000, "thief");
  CHECK(fixture.answer(164) == "nack queue_full");
  fixture.send(MessageType::request, "position", 7, 5000);
  CHECK(fixture.answer(7).empty());
  CHECK(fixture.answer(163) == "nack queue_full");
  fixture.messages.on_said({MessageType::information, "position", "operator", "[1,2]"}, fixture.out);
  CHECK(fixture.answer(7) == "[1,2]");
}

TEST_CASE("who waits in vain is told so: at the deadline, or when the robot leaves") {
  UserMessagesFixture fixture;
  fixture.send(MessageType::command, "move", 7);
  fixture.send(MessageType::request, "position", 8, 5000);
  fixture.now.mono = *fixture.messages.next_deadline();
  fixture.messages.tick(fixture.now, fixture.out);
  CHECK(fixture.answer(7) == "nack timeout");
  CHECK(fixture.answer(8).empty());
  fixture.messages.on_link_down(fixture.robot.field(), "gone", fixture.out);
  CHECK(fixture.answer(8) == "nack robot_offline");
  CHECK_FALSE(fixture.messages.next_deadline());
}

TEST_CASE("a message that is too late, or for a robot that is not there, goes nowhere") {
  UserMessagesFixture fixture;
  fixture.send(MessageType::command, "move", 7, 0);
  CHECK(fixture.answer(7) == "nack expired");
  UserMessagesFixture alone(false);
  alone.send(MessageType::command, "move", 7);
  CHECK(alone.answer(7) == "nack no_field_channel");
  CHECK_FALSE(alone.control.holder());
}

TEST_CASE("a Nack of the user's own word goes back to the robot, one of the middleware's is counted") {
  UserMessagesFixture fixture;
  const Inbound message{MessageType::information, "ur3", "pioneer", 9, 3, 0, 0, Nack{}};
  fixture.messages.on_nack(message, Nack{"offline", "greeting", "ur3", "no such node", "", ""}, fixture.now,
                           fixture.out);
  CHECK_FALSE(fixture.robot.take_output().writes.empty());
  fixture.messages.on_nack(message, Nack{"offline", "outcome", "ur3", "no such node", "", ""}, fixture.now,
                           fixture.out);
  CHECK(fixture.out.counts.back() == "refused.nack_outcome");
}

TEST_CASE("information named as a word that drives the robot is not given to it") {
  Settings settings = pioneer();
  Drive drive;
  drive.command = make_skill("roll", "{x}", {make_parameter("x", ParameterType::number)});
  drive.stand = make_skill("freeze", "");
  settings.description.drives = {drive};
  Fixture fixture(std::move(settings));
  fixture.up(Channel::field);
  for (const char* word : {"roll", "Freeze", "home"}) fixture.send(MessageType::information, word, "1", "ur3");
  CHECK(fixture.written().empty());
  CHECK(fixture.counted("refused.not_as_command") == 3);
  fixture.send(MessageType::information, "greeting", "hello", "ur3");
  CHECK_FALSE(fixture.written().empty());
}
