// The interpreter mode, told as conversations between the fleet, the core and a robot on its field channel.
#include "services/mode-adapter/test/bench.hpp"

using namespace trb;
using namespace trb::adapter;

namespace {

class FieldBench : public Bench {
 public:
  explicit FieldBench(Settings settings = pioneer()) : Bench(std::move(settings)) { up(Channel::field); }
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
  FieldBench bench;
  const auto id = bench.command("move", "1 2");
  CHECK(bench.written() == "command\n");
  bench.say("ok\n");
  CHECK(bench.written() == "move\n");
  bench.say("ok\n");
  CHECK(bench.written() == "operator\n");
  bench.say("ok\n");
  CHECK(bench.written() == "3\n");
  bench.say("ok\n");
  CHECK(bench.written() == "1 2\n");
  CHECK(bench.answer(id).empty());
  bench.say("ok\n");
  CHECK(bench.answer(id) == "ack handed_over");
  CHECK(bench.counted("to_robot.move") == 5);
  CHECK(bench.counted("from_robot.ready") == 1);
}

TEST_CASE("without acknowledgements all five fields leave at once") {
  FieldChannel channel;
  channel.acknowledge = false;
  FieldBench bench(with_channel(channel));
  const auto id = bench.command("say", "a\\b\nc");
  CHECK(bench.written() == "command\nsay\noperator\n5\na\\\\b\\nc\n");
  CHECK(bench.answer(id) == "ack handed_over");
}

TEST_CASE("with the delay framing fields leave one pause apart, and the reader finds the borders by the pauses") {
  FieldChannel channel;
  channel.framing = Framing::delay;
  channel.delay_s = 0.01;
  FieldBench bench(with_channel(channel));
  const auto id = bench.command("say", "hello");
  CHECK(bench.written() == "command");
  bench.wait(0.009);
  CHECK(bench.written().empty());
  bench.wait(0.001);
  CHECK(bench.written() == "say");
  bench.wait(0.03);
  CHECK(bench.written() == "operator5hello");
  CHECK(bench.answer(id) == "ack handed_over");

  for (const char* field : {"information", "heat", "ur3", "2", "17"}) {
    bench.say(field);
    bench.wait(0.01);
  }
  CHECK(bench.one<Opaque>() == Opaque{"heat", "17"});
}

TEST_CASE("with the delay framing empty data has no field of its own") {
  FieldChannel channel;
  channel.framing = Framing::delay;
  FieldBench bench(with_channel(channel));
  const auto id = bench.command("home", "");
  bench.wait(1);
  CHECK(bench.written() == "commandhomeoperator0");
  CHECK(bench.answer(id) == "ack handed_over");
}

TEST_CASE("length framing escapes nothing and counts in four bytes") {
  FieldChannel channel;
  channel.framing = Framing::length;
  channel.acknowledge = false;
  FieldBench bench(with_channel(channel));
  bench.command("say", "a\nb");
  using namespace std::string_literals;
  CHECK(bench.written() == "\0\0\0\7command\0\0\0\3say\0\0\0\x08operator\0\0\0\1"s + "3\0\0\0\3a\nb"s);
  bench.say("\0\0\0\7comm"s);
  bench.say("and\0\0\0\4move\0\0\0\3ur3\0\0\0\1"s + "0\0\0\0\0"s);
  CHECK(bench.one<Opaque>() == Opaque{"move", ""});
}

TEST_CASE("long data leaves in chunks, an escape is never cut, each chunk is acknowledged") {
  FieldChannel channel;
  channel.chunk_bytes = 4;
  FieldBench bench(with_channel(channel));
  const auto id = bench.command("say", "abc\ndef");
  CHECK(bench.take_fields(4) == "command\nsay\noperator\n7\n");
  CHECK(bench.written() == "abc\n");
  bench.say("ok\n");
  CHECK(bench.written() == "\\nde\n");
  bench.say("ok\n");
  CHECK(bench.written() == "f\n");
  CHECK(bench.answer(id).empty());
  bench.say("ok\n");
  CHECK(bench.answer(id) == "ack handed_over");
  CHECK(bench.counted("to_robot.say") == 7);
}

TEST_CASE("a message of the robot's arrives byte by byte and goes to the node that it names") {
  FieldBench bench;
  for (const char c : std::string("information\r\nheat\r\nur3\r\n4\r\n1\\\\2\\n\r\n")) bench.say({&c, 1});
  const auto said = bench.told<Opaque>();
  REQUIRE(said.size() == 1);
  CHECK(said[0].type == MessageType::information);
  CHECK(said[0].target == "ur3");
  CHECK(get<Opaque>(said[0].body) == Opaque{"heat", "1\\2\n"});
  CHECK(bench.counted("from_robot.heat") == 1);
}

TEST_CASE("a megabyte in many chunks is one message") {
  FieldBench bench;
  bench.say("command\nmap\nur3\n" + std::to_string(kMaxDataSize) + "\n");
  const std::string chunk(4096, 'm');
  for (std::size_t sent = 0; sent < kMaxDataSize; sent += chunk.size()) bench.say(chunk + "\n");
  const auto said = bench.told<Opaque>();
  REQUIRE(said.size() == 1);
  CHECK(said[0].type == MessageType::command);
  CHECK(said[0].flags == kFlagNoAnswer);
  CHECK(get<Opaque>(said[0].body).data.size() == kMaxDataSize);
  CHECK(bench.closed().empty());
}

TEST_CASE("the robot may say something of its own while the node waits for an ok") {
  FieldBench bench;
  const auto id = bench.command("move", "1");
  bench.say("information\nheat\nur3\n1\n7\nok\n");
  CHECK(bench.one<Opaque>() == Opaque{"heat", "7"});
  CHECK(bench.written() == "command\nmove\n");
  bench.say("ok\nok\nok\nok\n");
  CHECK(bench.answer(id) == "ack handed_over");
}

TEST_CASE("what is no message of the grammar closes the connection, and says why") {
  for (const auto& [bytes, reason] :
       std::vector<std::pair<std::string, std::string>>{{"hello\n", "bad_type"},
                                                        {"command\nmove\nur3\nmany\n", "bad_size"},
                                                        {"command\nmove\nur3\n-1\n", "bad_size"},
                                                        {"command\nmove\nur3\n99999999\n", "message_too_long"},
                                                        {"command\nmove\nur3\n2\nabc\n", "size_mismatch"}}) {
    FieldBench bench;
    bench.say(bytes);
    CHECK(bench.closed().starts_with(reason));
    CHECK(bench.counted("refused." + reason) == 1);
    CHECK(bench.told<Opaque>().empty());
  }
}

TEST_CASE("a field without an end closes the connection before it fills the memory") {
  FieldBench bench;
  const std::string piece(1U << 16U, 'x');
  std::string closed;
  for (int i = 0; i < 64 && closed.empty(); ++i) {
    bench.say(piece);
    closed = bench.closed();
  }
  CHECK(closed == "field_too_long;");
}

TEST_CASE("the middleware's own words and targets that are none are refused to the robot, the stream goes on") {
  FieldBench bench;
  bench.say("command\nstop\nur3\n0\n\ninformation\nheat\nUR 3\n1\n1\ncommand\nmo ve\nur3\n0\n\n");
  CHECK(bench.out.sends.empty());
  CHECK(bench.counted("refused.typed_subtype") == 1);
  CHECK(bench.counted("refused.bad_target") == 1);
  CHECK(bench.counted("refused.bad_subtype") == 1);
  bench.say("information\nheat\nur3\n1\n1\n");
  CHECK(bench.one<Opaque>() == Opaque{"heat", "1"});
}

TEST_CASE("a robot that does not acknowledge in time loses its connection, the message's sender is told") {
  FieldBench bench;
  const auto id = bench.command("move", "1");
  const auto second = bench.command("move", "2");
  bench.wait(1.9);
  CHECK(bench.closed().empty());
  bench.wait(0.1);
  CHECK(bench.closed() == "ack_timeout;");
  CHECK(bench.answer(id) == "nack timeout");
  CHECK(bench.answer(second) == "nack timeout");
  CHECK(bench.counted("refused.ack_timeout") == 1);
}

TEST_CASE("a robot that leaves in the middle of a field takes nothing along into its next connection") {
  FieldBench bench;
  const auto id = bench.command("move", "1 2 3");
  bench.take_fields(2);
  bench.say("information\nhea");
  bench.down(Channel::field);
  CHECK(bench.answer(id) == "nack robot_offline");
  bench.up(Channel::field);
  bench.written();
  bench.say("information\nheat\nur3\n1\n1\n");
  CHECK(bench.one<Opaque>() == Opaque{"heat", "1"});
  bench.command("move", "4");
  CHECK(bench.take_fields() == "command\nmove\noperator\n1\n4\n");
}

TEST_CASE("the queue is bounded: the message that finds it full is answered at once") {
  FieldBench bench;
  for (int i = 0; i < 64; ++i) CHECK(bench.answer(bench.command("move", "1")).empty());
  CHECK(bench.answer(bench.command("move", "1")) == "nack queue_full");
}

TEST_CASE("a message that waits longer than its deadline is never handed over") {
  FieldBench bench;
  bench.command("move", "1");
  bench.remaining_ms = 1000;
  const auto id = bench.command("turn", "2");
  bench.wait(1);
  CHECK(bench.answer(id) == "nack timeout");
  bench.take_fields(8);
  CHECK(bench.counted("to_robot.turn") == 0);
  bench.remaining_ms = 0;
  CHECK(bench.answer(bench.command("move", "1")) == "nack expired");
}

TEST_CASE("with no robot on TCP_PORT a command is refused, information is dropped and counted") {
  Bench bench(pioneer());
  CHECK(bench.answer(bench.command("move", "1")) == "nack no_field_channel");
  bench.send(MessageType::information, "heat", "1");
  CHECK(bench.told<Nack>().size() == 1);
  CHECK(bench.counted("refused.no_field_channel") == 2);
}

TEST_CASE("a request is answered by the robot's information of that name to the asker") {
  FieldBench bench;
  const auto id = bench.send(MessageType::request, "position", "");
  CHECK(bench.take_fields() == "request\nposition\noperator\n0\n\n");
  bench.say("information\nposition\nur3\n1\n9\n");  // to somebody else: no answer
  CHECK(bench.answer(id).empty());
  bench.say("information\nposition\noperator\n3\n1 2\n");
  const auto said = bench.told<Opaque>();
  REQUIRE(said.size() == 2);
  CHECK(said[0].target == "ur3");
  CHECK(said[0].reply_to == 0);
  CHECK(said[1].target == "operator");
  CHECK(said[1].reply_to == id);
  CHECK(get<Opaque>(said[1].body) == Opaque{"position", "1 2"});
  bench.say("information\nposition\noperator\n3\n1 3\n");
  CHECK(bench.told<Opaque>()[0].reply_to == 0);  // nobody waits any more
}

TEST_CASE("a request that the robot leaves unanswered times out; one that it cannot answer any more is refused") {
  FieldBench bench;
  bench.remaining_ms = 500;
  const auto id = bench.send(MessageType::request, "position", "");
  bench.take_fields();
  bench.wait(0.5);
  CHECK(bench.answer(id) == "nack timeout");
  bench.remaining_ms = 5000;
  const auto second = bench.send(MessageType::request, "position", "");
  bench.take_fields();
  bench.down(Channel::field);
  CHECK(bench.answer(second) == "nack robot_offline");
}

TEST_CASE("what the robot has asked itself comes back as information, a refusal as `nack`") {
  FieldBench bench;
  bench.say("request\ntime\nur3\n0\n\n");
  const auto asked = bench.told<Opaque>();
  REQUIRE(asked.size() == 1);
  CHECK(asked[0].type == MessageType::request);
  bench.deliver(MessageType::information, Opaque{"time", "12"}, "ur3", 55);
  CHECK(bench.take_fields() == "information\ntime\nur3\n2\n12\n");
  bench.deliver(MessageType::information, Nack{"unknown_target", "time", "ur4", "no such node", ""}, "pioneer", 56);
  CHECK(bench.take_fields() == "information\nnack\npioneer\n27\nunknown_target no such node\n");
  bench.deliver(MessageType::information, Nack{"no_service", "outcome", "pioneer", "", ""}, "pioneer", 57);
  CHECK(bench.written().empty());
}

TEST_CASE("numbers instead of words") {
  FieldBench bench(numeric());
  const auto id = bench.command("move", "1.5 -2");
  std::string fields;
  for (int i = 0; i < 5; ++i) {
    fields += bench.written();
    bench.say("0\n");
  }
  CHECK(fields == "1\n11\n5\n6\n1.5 -2\n");
  CHECK(bench.answer(id) == "ack handed_over");
  bench.say("3\n12\n6\n3\n4 5\n");
  CHECK(bench.one<Opaque>() == Opaque{"position", "4 5"});
  CHECK(bench.nack_of(bench.command("dance", "1")).code == "unknown_subtype");
  CHECK(bench.nack_of(bench.command("dance", "1")).cure.find("field_channel.codes") != std::string::npos);
  CHECK(bench.answer(bench.command("move", "left")) == "nack bad_value");
  bench.flags = kFlagTakeControl;
  CHECK(bench.answer(bench.send(MessageType::command, "move", "1", "stranger")) == "nack unknown_subtype");
  bench.say("3\n99\n6\n1\n4\n");
  CHECK(bench.counted("refused.bad_subtype") == 1);
  bench.say("3\n12\n99\n1\n4\n");
  CHECK(bench.counted("refused.bad_target") == 1);
}

TEST_CASE("a fault of the robot's is told to every node") {
  FieldBench good;
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

  FieldBench in_numbers(numeric());
  in_numbers.say("3\n31\n0\n4\n30 2\n");
  CHECK(in_numbers.one<RobotFault>().severity == Severity::urgent);
  in_numbers.say("3\n31\n0\n4\n30 4\n");
  in_numbers.out.clear();
  in_numbers.say("3\n31\n0\n4\n30 0\n");
  CHECK(in_numbers.over().size() == 1);
}
