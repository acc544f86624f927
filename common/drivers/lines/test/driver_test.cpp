// The interpreter mode, as conversations between the fleet, the core and a robot on its field channel.
#include "services/mode-adapter/test/fixture.hpp"

using namespace trb;
using namespace trb::adapter;

namespace {

class FieldFixture : public Fixture {
 public:
  explicit FieldFixture(Settings settings = pioneer()) : Fixture(std::move(settings)) { up(Channel::field); }
};

Settings with_channel(const FieldChannel& channel) {
  Settings settings = pioneer();
  settings.description.field_channel = channel;
  return settings;
}

Settings numeric() {
  FieldChannel channel;
  channel.encoding = Encoding::numeric;
  channel.subtype_codes = {{"move", 11},  {"position", 12}, {"done", 21}, {"failed", 22},
                           {"go_to", 13}, {"mobile", 30},   {"fault", 31}};
  channel.id_codes = {{"operator", 5}, {"ur3", 6}};
  return with_channel(channel);
}

}  // namespace

TEST_CASE("a command goes field by field, each after the robot's ok, and is answered when the last one is taken") {
  FieldFixture fixture;
  const auto id = fixture.command("move", "1 2");
  CHECK(fixture.written() == "command\n");
  fixture.say("ok\n");
  CHECK(fixture.written() == "move\n");
  fixture.say("ok\n");
  CHECK(fixture.written() == "operator\n");
  fixture.say("ok\n");
  CHECK(fixture.written() == "3\n");
  fixture.say("ok\n");
  CHECK(fixture.written() == "1 2\n");
  CHECK(fixture.answer(id).empty());
  fixture.say("ok\n");
  CHECK(fixture.answer(id) == "ack handed_over");
  CHECK(fixture.counted("to_robot.move") == 5);
  CHECK(fixture.counted("from_robot.ready") == 1);
}

TEST_CASE("without acknowledgements all five fields leave at once") {
  FieldChannel channel;
  channel.acknowledge = false;
  FieldFixture fixture(with_channel(channel));
  const auto id = fixture.command("say", "a\\b\nc");
  CHECK(fixture.written() == "command\nsay\noperator\n5\na\\\\b\\nc\n");
  CHECK(fixture.answer(id) == "ack handed_over");
}

TEST_CASE(
    "without acknowledgements a state that was on its way already ends no skill: it has to change, or stay for 2 s") {
  for (const bool changes : {true, false}) {
    FieldChannel channel;
    channel.acknowledge = false;
    Settings settings = with_channel(channel);
    settings.description.skills[0].end = SkillEnd{EndKind::state, "idle", 1, 0, "", 0};
    FieldFixture fixture(std::move(settings));
    const std::string idle = "information\nidle\n\n1\n1\n";
    fixture.deliver(MessageType::command, order("go_to", R"({"place": "dock"})"), "pioneer");
    fixture.say(idle);
    fixture.wait(0.5);
    fixture.say(idle);
    CHECK(fixture.told<Outcome>().empty());
    if (changes) fixture.say("information\nidle\n\n1\n0\n");
    fixture.wait(changes ? 0.1 : 1.4);
    CHECK(fixture.told<Outcome>().empty());
    fixture.wait(changes ? 0 : 0.2);
    if (changes) fixture.say(idle);
    CHECK(fixture.one<Outcome>().outcome == TaskOutcome::finished);
  }
}

TEST_CASE("with the delay framing fields leave one pause apart, and the reader finds the borders by the pauses") {
  FieldChannel channel;
  channel.framing = Framing::delay;
  channel.delay_s = 0.01;
  FieldFixture fixture(with_channel(channel));
  const auto id = fixture.command("say", "hello");
  CHECK(fixture.written() == "command");
  fixture.wait(0.009);
  CHECK(fixture.written().empty());
  fixture.wait(0.001);
  CHECK(fixture.written() == "say");
  fixture.wait(0.03);
  CHECK(fixture.written() == "operator5hello");
  CHECK(fixture.answer(id) == "ack handed_over");

  for (const char* field : {"information", "heat", "ur3", "2", "17"}) {
    fixture.say(field);
    fixture.wait(0.01);
  }
  CHECK(fixture.one<Opaque>() == Opaque{"heat", "17"});
}

TEST_CASE("with the delay framing empty data has no field of its own") {
  FieldChannel channel;
  channel.framing = Framing::delay;
  FieldFixture fixture(with_channel(channel));
  const auto id = fixture.command("home", "");
  fixture.wait(1);
  CHECK(fixture.written() == "commandhomeoperator0");
  CHECK(fixture.answer(id) == "ack handed_over");
}

TEST_CASE(
    "stops and releases that come faster than the pauses let them leave: the robot stops, and the last one holds") {
  for (const bool released : {false, true}) {
    FieldChannel channel;
    channel.framing = Framing::delay;
    channel.delay_s = 0.1;
    channel.acknowledge = false;
    FieldFixture fixture(with_channel(channel));
    for (int i = 0; i < 1000; ++i) {
      fixture.deliver(MessageType::command, Stop{"test"});
      fixture.deliver(MessageType::command, Release{});
    }
    if (!released) fixture.deliver(MessageType::command, Stop{"test"});
    fixture.written();
    fixture.wait(6.8);  // 68 pauses
    const std::string orders = fixture.written();
    CHECK(orders.ends_with(released ? "!stop!release" : "!release!stop"));
    fixture.wait(20);
    CHECK(fixture.written().empty());
  }
}

TEST_CASE("length framing escapes nothing and counts in four bytes") {
  FieldChannel channel;
  channel.framing = Framing::length;
  channel.acknowledge = false;
  FieldFixture fixture(with_channel(channel));
  fixture.command("say", "a\nb");
  using namespace std::string_literals;
  CHECK(fixture.written() == "\0\0\0\7command\0\0\0\3say\0\0\0\x08operator\0\0\0\1"s + "3\0\0\0\3a\nb"s);
  fixture.say("\0\0\0\7comm"s);
  fixture.say("and\0\0\0\4move\0\0\0\3ur3\0\0\0\1"s + "0\0\0\0\0"s);
  CHECK(fixture.one<Opaque>() == Opaque{"move", ""});
}

TEST_CASE("long data leaves in chunks, an escape is never cut, each chunk is acknowledged") {
  FieldChannel channel;
  channel.chunk_bytes = 4;
  FieldFixture fixture(with_channel(channel));
  const auto id = fixture.command("say", "abc\ndef");
  CHECK(fixture.take_fields(4) == "command\nsay\noperator\n7\n");
  CHECK(fixture.written() == "abc\n");
  fixture.say("ok\n");
  CHECK(fixture.written() == "\\nde\n");
  fixture.say("ok\n");
  CHECK(fixture.written() == "f\n");
  CHECK(fixture.answer(id).empty());
  fixture.say("ok\n");
  CHECK(fixture.answer(id) == "ack handed_over");
  CHECK(fixture.counted("to_robot.say") == 7);
}

TEST_CASE("a message of the robot's arrives byte by byte and goes to the node that it names") {
  FieldFixture fixture;
  for (const char c : std::string("information\r\nheat\r\nur3\r\n4\r\n1\\\\2\\n\r\n")) fixture.say({&c, 1});
  const auto said = fixture.told<Opaque>();
  REQUIRE(said.size() == 1);
  CHECK(said[0].type == MessageType::information);
  CHECK(said[0].target == "ur3");
  CHECK(get<Opaque>(said[0].body) == Opaque{"heat", "1\\2\n"});
  CHECK(fixture.counted("from_robot.heat") == 1);
}

TEST_CASE("a megabyte in many chunks is one message") {
  FieldFixture fixture;
  fixture.say("command\nmap\nur3\n" + std::to_string(kMaxDataSize) + "\n");
  const std::string chunk(4096, 'm');
  for (std::size_t sent = 0; sent < kMaxDataSize; sent += chunk.size()) fixture.say(chunk + "\n");
  const auto said = fixture.told<Opaque>();
  REQUIRE(said.size() == 1);
  CHECK(said[0].type == MessageType::command);
  CHECK(said[0].flags == kFlagNoAnswer);
  CHECK(get<Opaque>(said[0].body).data.size() == kMaxDataSize);
  CHECK(fixture.closed().empty());
}

TEST_CASE("the robot may say something of its own while the node waits for an ok") {
  FieldFixture fixture;
  const auto id = fixture.command("move", "1");
  fixture.say("information\nheat\nur3\n1\n7\nok\n");
  CHECK(fixture.one<Opaque>() == Opaque{"heat", "7"});
  CHECK(fixture.written() == "command\nmove\n");
  fixture.say("ok\nok\nok\nok\n");
  CHECK(fixture.answer(id) == "ack handed_over");
}

TEST_CASE("what is no message of the grammar closes the connection, and says why") {
  for (const auto& [bytes, reason] :
       std::vector<std::pair<std::string, std::string>>{{"hello\n", "bad_type"},
                                                        {"command\nmove\nur3\nmany\n", "bad_size"},
                                                        {"command\nmove\nur3\n-1\n", "bad_size"},
                                                        {"command\nmove\nur3\n99999999\n", "message_too_long"},
                                                        {"command\nmove\nur3\n2\nabc\n", "size_mismatch"}}) {
    FieldFixture fixture;
    fixture.say(bytes);
    CHECK(fixture.closed().starts_with(reason));
    CHECK(fixture.counted("refused." + reason) == 1);
    CHECK(fixture.told<Opaque>().empty());
  }
}

TEST_CASE("a field without an end closes the connection before it fills the memory") {
  FieldFixture fixture;
  const std::string piece(1U << 16U, 'x');
  std::string closed;
  for (int i = 0; i < 64 && closed.empty(); ++i) {
    fixture.say(piece);
    closed = fixture.closed();
  }
  CHECK(closed == "field_too_long;");
}

TEST_CASE("the middleware's own words and targets that are none are refused to the robot, the stream goes on") {
  FieldFixture fixture;
  fixture.say("command\nstop\nur3\n0\n\ninformation\nheat\nUR 3\n1\n1\ncommand\nmo ve\nur3\n0\n\n");
  CHECK(fixture.out.sends.empty());
  CHECK(fixture.counted("refused.typed_subtype") == 1);
  CHECK(fixture.counted("refused.bad_target") == 1);
  CHECK(fixture.counted("refused.bad_subtype") == 1);
  fixture.say("information\nheat\nur3\n1\n1\n");
  CHECK(fixture.one<Opaque>() == Opaque{"heat", "1"});
}

TEST_CASE("a robot that does not acknowledge in time loses its connection, the message's sender is told") {
  FieldFixture fixture;
  const auto id = fixture.command("move", "1");
  const auto second = fixture.command("move", "2");
  fixture.wait(1.9);
  CHECK(fixture.closed().empty());
  fixture.wait(0.1);
  CHECK(fixture.closed() == "ack_timeout;");
  CHECK(fixture.answer(id) == "nack timeout");
  CHECK(fixture.answer(second) == "nack timeout");
  CHECK(fixture.counted("refused.ack_timeout") == 1);
}

TEST_CASE("a robot that leaves in the middle of a field takes nothing along into its next connection") {
  FieldFixture fixture;
  const auto id = fixture.command("move", "1 2 3");
  fixture.take_fields(2);
  fixture.say("information\nhea");
  fixture.down(Channel::field);
  CHECK(fixture.answer(id) == "nack robot_offline");
  fixture.up(Channel::field);
  fixture.written();
  fixture.say("information\nheat\nur3\n1\n1\n");
  CHECK(fixture.one<Opaque>() == Opaque{"heat", "1"});
  fixture.command("move", "4");
  CHECK(fixture.take_fields() == "command\nmove\noperator\n1\n4\n");
}

TEST_CASE("the queue is bounded: the message that finds it full is answered at once") {
  FieldFixture fixture;
  for (int i = 0; i < 64; ++i) CHECK(fixture.answer(fixture.command("move", "1")).empty());
  CHECK(fixture.answer(fixture.command("move", "1")) == "nack queue_full");
}

TEST_CASE("a message that waits longer than its deadline is never handed over") {
  FieldFixture fixture;
  fixture.command("move", "1");
  fixture.remaining_ms = 1000;
  const auto id = fixture.command("turn", "2");
  fixture.wait(1);
  CHECK(fixture.answer(id) == "nack timeout");
  fixture.take_fields(8);
  CHECK(fixture.counted("to_robot.turn") == 0);
  fixture.remaining_ms = 0;
  CHECK(fixture.answer(fixture.command("move", "1")) == "nack expired");
}

TEST_CASE("with no robot on TCP_PORT a command is refused, information is dropped and counted") {
  Fixture fixture(pioneer());
  CHECK(fixture.answer(fixture.command("move", "1")) == "nack no_field_channel");
  fixture.send(MessageType::information, "heat", "1");
  CHECK(fixture.told<Nack>().size() == 1);
  CHECK(fixture.counted("refused.no_field_channel") == 2);
}

TEST_CASE("a request is answered by the robot's information of that name to the requester") {
  FieldFixture fixture;
  const auto id = fixture.send(MessageType::request, "position", "");
  CHECK(fixture.take_fields() == "request\nposition\noperator\n0\n\n");
  fixture.say("information\nposition\nur3\n1\n9\n");  // to another node: no answer
  CHECK(fixture.answer(id).empty());
  fixture.say("information\nposition\noperator\n3\n1 2\n");
  const auto said = fixture.told<Opaque>();
  REQUIRE(said.size() == 2);
  CHECK(said[0].target == "ur3");
  CHECK(said[0].reply_to == 0);
  CHECK(said[1].target == "operator");
  CHECK(said[1].reply_to == id);
  CHECK(get<Opaque>(said[1].body) == Opaque{"position", "1 2"});
  fixture.say("information\nposition\noperator\n3\n1 3\n");
  CHECK(fixture.told<Opaque>()[0].reply_to == 0);  // no requester waits any more
}

TEST_CASE("a request that the robot leaves unanswered times out; one that it cannot answer any more is refused") {
  FieldFixture fixture;
  fixture.remaining_ms = 500;
  const auto id = fixture.send(MessageType::request, "position", "");
  fixture.take_fields();
  fixture.wait(0.5);
  CHECK(fixture.answer(id) == "nack timeout");
  fixture.remaining_ms = 5000;
  const auto second = fixture.send(MessageType::request, "position", "");
  fixture.take_fields();
  fixture.down(Channel::field);
  CHECK(fixture.answer(second) == "nack robot_offline");
}

TEST_CASE("what the robot has asked itself comes back as information, a refusal as `nack`") {
  FieldFixture fixture;
  fixture.say("request\ntime\nur3\n0\n\n");
  const auto asked = fixture.told<Opaque>();
  REQUIRE(asked.size() == 1);
  CHECK(asked[0].type == MessageType::request);
  fixture.deliver(MessageType::information, Opaque{"time", "12"}, "ur3", 55);
  CHECK(fixture.take_fields() == "information\ntime\nur3\n2\n12\n");
  fixture.deliver(MessageType::information, Nack{"unknown_target", "time", "ur4", "no such node", ""}, "pioneer", 56);
  CHECK(fixture.take_fields() == "information\nnack\npioneer\n27\nunknown_target no such node\n");
  fixture.deliver(MessageType::information, Nack{"no_service", "outcome", "pioneer", "", ""}, "pioneer", 57);
  CHECK(fixture.written().empty());
}

TEST_CASE("numbers instead of words") {
  FieldFixture fixture(numeric());
  const auto id = fixture.command("move", "1.5 -2");
  std::string fields;
  for (int i = 0; i < 5; ++i) {
    fields += fixture.written();
    fixture.say("0\n");
  }
  CHECK(fields == "1\n11\n5\n6\n1.5 -2\n");
  CHECK(fixture.answer(id) == "ack handed_over");
  fixture.say("3\n12\n6\n3\n4 5\n");
  CHECK(fixture.one<Opaque>() == Opaque{"position", "4 5"});
  CHECK(fixture.nack_of(fixture.command("dance", "1")).code == "unknown_subtype");
  CHECK(fixture.nack_of(fixture.command("dance", "1")).hint.find("field_channel.codes") != std::string::npos);
  CHECK(fixture.answer(fixture.command("move", "left")) == "nack bad_value");
  fixture.flags = kFlagTakeControl;
  CHECK(fixture.answer(fixture.send(MessageType::command, "move", "1", "stranger")) == "nack unknown_subtype");
  fixture.say("3\n99\n6\n1\n4\n");
  CHECK(fixture.counted("refused.bad_subtype") == 1);
  fixture.say("3\n12\n99\n1\n4\n");
  CHECK(fixture.counted("refused.bad_target") == 1);
}

TEST_CASE("a fault of the robot's is told to every node") {
  FieldFixture good;
  good.say("information\nfault\n\n26\nmobile CRITICAL left wheel\n");
  const auto said = good.told<RobotFault>();
  REQUIRE(said.size() == 1);
  CHECK(said[0].target == "*");
  const auto& fault = get<RobotFault>(said[0].body);
  CHECK(fault.capability == "mobile");
  CHECK(fault.severity == Severity::critical);
  CHECK(fault.text == "left wheel");
  good.say("information\nfault\n\n6\nmobile\n");
  CHECK(good.counted("refused.bad_fault") == 1);

  FieldFixture in_numbers(numeric());
  in_numbers.say("3\n31\n0\n4\n30 2\n");
  CHECK(in_numbers.one<RobotFault>().severity == Severity::urgent);
  in_numbers.say("3\n31\n0\n4\n30 4\n");
  in_numbers.out.clear();
  in_numbers.say("3\n31\n0\n4\n30 0\n");
  CHECK(in_numbers.over().size() == 1);
}
