// The direct mode over Modbus: one call at a time, whose answers the test gives as a device would.
#include "common/drivers/modbus/call.hpp"
#include "services/mode-adapter/test/bench.hpp"

using namespace trb;
using namespace trb::adapter;

namespace {

Settings conveyor() {
  Settings settings;
  settings.id = "conveyor";
  settings.framework = "plc";
  settings.mode = Mode::direct;
  settings.instance = kInstance;
  settings.description.capabilities = {"convey"};
  settings.description.skills = {make_skill("run", "{speed}", {make_parameter("speed", ParameterType::number, "m/s")}),
                                 make_skill("reset", "")};
  settings.description.skills[0].end.kind = EndKind::state;
  settings.description.skills[0].end.state = "at_exit";
  settings.description.skills[0].end.equals = 1;
  settings.commands.transport = "modbus";
  settings.commands.values = {{"running", "coil 0"},          {"at_exit", "discrete 3"},
                              {"speed", "holding 0 * 0.001"}, {"position", "input 0 * 0.001"},
                              {"boxes", "input 1 uint32"},    {"unused", "input 99"}};
  settings.commands.commands = {{"run", "speed = {data}\nrunning = 1"},
                                {"set_speed", "speed = {data}"},
                                {"jog", "speed = {0}\nrunning = {1}"},
                                {"reset", "coil 1 = true"},
                                {"stop", "running = 0"},
                                {"release", ""}};
  settings.commands.requests = {{"speed", "speed"}, {"position", "position"}, {"boxes", "boxes"}};
  return settings;
}

/// What a person would read in a trace: "write holding 0 250" or "read input 0 x3".
std::string text_of(const ModbusCall& call) {
  const std::string where = std::string(name_of(call.kind)) + " " + std::to_string(call.address);
  if (!call.write) return "read " + where + " x" + std::to_string(call.count);
  std::string out = "write " + where;
  for (const auto word : call.words) out += " " + std::to_string(word);
  return out;
}

/// A conveyor's device, whose registers the test sets.
struct PlcBench : Bench {
  explicit PlcBench(Settings settings = conveyor()) : Bench(std::move(settings)) {}

  /// The calls since the last look; there is never more than one without an answer.
  std::string asked() {
    std::string text;
    for (const RobotWrite& write : out.writes) {
      const auto call = decode_modbus_call(write.bytes);
      REQUIRE(call.has_value());
      waiting = *call;
      text += (text.empty() ? "" : "; ") + text_of(*call);
    }
    out.writes.clear();
    return text;
  }
  void answer_call(std::uint8_t exception = 0, const std::vector<std::uint16_t>& words = {}) {
    hear(Channel::command, encode(ModbusAnswer{exception, words}));
  }
  std::vector<std::uint16_t> registers_of(const ModbusCall& call) {
    std::vector<std::uint16_t> words;
    for (int i = 0; i < (call.write ? 0 : call.count); ++i) words.push_back(memory[{call.kind, call.address + i}]);
    return words;
  }
  /// The device answers all that it is asked, until it is asked no more at this time. Returns the writes.
  std::string serve() {
    std::string writes;
    for (std::string call = asked(); !call.empty(); call = asked()) {
      if (waiting.write) writes += (writes.empty() ? "" : "; ") + call.substr(6);
      for (std::size_t i = 0; i < waiting.words.size(); ++i) {
        memory[{waiting.kind, waiting.address + int(i)}] = waiting.words[i];
      }
      answer_call(0, registers_of(waiting));
    }
    return writes;
  }
  /// Time, in which the device answers.
  void live(double time_s) {
    for (double t = 0; t < time_s - 1e-9; t += 0.05) {
      wait(0.05);
      serve();
    }
  }
  void connect() {
    up(Channel::command);
    serve();
  }

  std::map<std::pair<ModbusKind, int>, std::uint16_t> memory;
  ModbusCall waiting;
};

std::string online(Bench& bench) {
  bench.deliver(MessageType::request, AdapterStateRequest{}, "conveyor");
  const auto states = bench.told<AdapterState>();
  REQUIRE_FALSE(states.empty());
  return get<AdapterState>(states.back().body).robot;
}

constexpr ModbusKind kHolding = ModbusKind::holding;
constexpr ModbusKind kInput = ModbusKind::input;
constexpr ModbusKind kDiscrete = ModbusKind::discrete;

}  // namespace

TEST_CASE("modbus: what requests and skills' ends need is asked for, neighbours in one call") {
  PlcBench bench;
  bench.up(Channel::command);
  std::string calls = bench.asked();
  for (int i = 0; i < 2; ++i) {
    bench.answer_call(0, bench.registers_of(bench.waiting));
    calls += "; " + bench.asked();
  }
  CHECK(calls == "read discrete 3 x1; read input 0 x3; read holding 0 x1");
  bench.answer_call(0, {250});
  CHECK(bench.asked().empty());
  bench.wait(0.09);
  CHECK(bench.asked().empty());
  bench.wait(0.01);
  CHECK(bench.asked() == "read discrete 3 x1");
}

TEST_CASE("modbus: a connection alone is no robot: it counts once it has answered") {
  PlcBench bench;
  bench.up(Channel::command);
  CHECK(online(bench) == "OFFLINE");
  CHECK(bench.answer(bench.command("set_speed", "0.25")) == "nack robot_offline");
  bench.asked();
  bench.answer_call(2);  // even an exception says that somebody is there
  CHECK(online(bench) == "ONLINE");
}

TEST_CASE("modbus: a command writes its registers in their order and is answered once the device has taken all") {
  PlcBench bench;
  bench.connect();
  const auto id = bench.command("jog", "[0.25, true]");
  CHECK(bench.asked() == "write holding 0 250");
  CHECK(bench.answer(id).empty());
  bench.answer_call();
  CHECK(bench.asked() == "write coil 0 1");
  CHECK(bench.answer(id).empty());
  bench.answer_call();
  CHECK(bench.answer(id) == "ack handed_over");
  CHECK(bench.counted("to_robot.jog") == 1);
  CHECK(bench.counted("from_robot.done") == 1);
}

TEST_CASE("modbus: two commands at once are written one after the other, none is lost or mixed") {
  PlcBench bench;
  bench.connect();
  const auto first = bench.command("jog", "[0.25, 1]");
  const auto second = bench.command("jog", "[0.5, 0]");
  CHECK(bench.serve() == "holding 0 250; coil 0 1; holding 0 500; coil 0 0");
  CHECK(bench.answer(first) == "ack handed_over");
  CHECK(bench.answer(second) == "ack handed_over");
}

TEST_CASE("modbus: data is numbers; anything else is refused before something is written") {
  PlcBench bench;
  bench.connect();
  const std::vector<std::pair<std::string, std::string>> cases = {
      {R"("0.25")", "the data holds a text '0.25', and Modbus carries numbers only"},
      {R"("x\" = 1\nrunning = 1")", "Modbus carries numbers only"},
      {"0.25\nrunning = 1", "the data is no JSON"},
      {"0.25\"", "the data is no JSON"},
      {"", "speed needs data, and there is none"},
      {"[0.25, 1]", "speed needs one number, and the data has 2 items"},
      {"[]", "the data has 0 items"},
      {"{}", "the data holds a"},
      {"null", "the data holds a"},
      {"70", "speed (holding 0): 70 does not fit holding 0, a uint16"},
      {"-0.001", "does not fit"},
  };
  for (const auto& [data, what] : cases) {
    CAPTURE(data);
    const auto id = bench.command("set_speed", data);
    CHECK(bench.nack_of(id).code == "bad_value");
    CHECK_MESSAGE(bench.nack_of(id).what.find(what) != std::string::npos, bench.nack_of(id).what);
    CHECK_FALSE(bench.nack_of(id).cure.empty());
  }
  const auto missing = bench.command("jog", "[0.25]");
  CHECK(bench.nack_of(missing).what == "running needs item 1 of a list, and the data has 1 items");
  CHECK(bench.asked().empty());
}

TEST_CASE("modbus: an exception names the register, itself and the cure, and the rest is not written") {
  PlcBench bench;
  bench.connect();
  const auto id = bench.command("run", "0.25");
  bench.asked();
  bench.answer_call(3);
  CHECK(bench.nack_of(id).code == "robot_error");
  CHECK(bench.nack_of(id).what == "speed (holding 0): the device answered 'illegal data value' (exception 3)");
  CHECK(bench.nack_of(id).cure == "give a value within the limits of the device's manual");
  CHECK(bench.asked().empty());
  const auto second = bench.command("run", "0.25");
  bench.asked();
  bench.answer_call();
  bench.asked();
  bench.answer_call(6);
  CHECK(bench.nack_of(second).what ==
        "running (coil 0): the device answered 'server device busy' (exception 6); the 1 writes before it were done");
}

TEST_CASE("modbus: a request is answered with what the device last told") {
  PlcBench bench;
  bench.memory[{kHolding, 0}] = 250;
  bench.memory[{kInput, 0}] = 1234;
  bench.memory[{kInput, 1}] = 1;
  bench.connect();
  CHECK(bench.answer(bench.send(MessageType::request, "speed", "")) == "0.25");
  CHECK(bench.answer(bench.send(MessageType::request, "position", "")) == "1.234");
  CHECK(bench.answer(bench.send(MessageType::request, "boxes", "")) == "65536");
  bench.memory[{kInput, 0}] = 1500;
  bench.live(0.15);
  CHECK(bench.answer(bench.send(MessageType::request, "position", "")) == "1.5");
}

TEST_CASE("modbus: a value that the device does not have is told once as a warning, and the others go on") {
  PlcBench bench;
  bench.up(Channel::command);
  const auto refuse_position = [&] {
    for (std::string call = bench.asked(); !call.empty(); call = bench.asked()) {
      const bool with_position = bench.waiting.kind == kInput && bench.waiting.address == 0;
      bench.answer_call(with_position ? 2 : 0,
                        with_position ? std::vector<std::uint16_t>{} : bench.registers_of(bench.waiting));
    }
  };
  refuse_position();
  const RobotFault fault = bench.one<RobotFault>();
  CHECK(fault.capability == "convey");
  CHECK(fault.severity == Severity::warning);
  CHECK(fault.text.starts_with("position (input 0): the device answered 'illegal data address' (exception 2); look"));
  CHECK(bench.answer(bench.send(MessageType::request, "boxes", "")) == "0");
  const auto id = bench.send(MessageType::request, "position", "");
  CHECK(bench.nack_of(id).code == "robot_error");
  CHECK(bench.nack_of(id).what == "position (input 0): the device answered 'illegal data address' (exception 2)");
  for (int i = 0; i < 20; ++i) {
    bench.wait(0.1);
    refuse_position();
  }
  CHECK(bench.told<RobotFault>().empty());
  bench.live(0.1);  // the device has it again
  CHECK(bench.answer(bench.send(MessageType::request, "position", "")) == "0");
  bench.wait(0.1);
  refuse_position();
  CHECK(bench.told<RobotFault>().size() == 1);
}

TEST_CASE("modbus: a skill ends when the value is as its description says") {
  PlcBench bench;
  bench.connect();
  bench.deliver(MessageType::command, order("run", R"({"speed": 0.5})"), "conveyor");
  CHECK(bench.serve() == "holding 0 500; coil 0 1");
  bench.live(3);
  CHECK(bench.told<Outcome>().empty());
  bench.memory[{kDiscrete, 3}] = 1;
  bench.live(0.2);
  CHECK(bench.one<Outcome>().outcome == TaskOutcome::finished);
}

TEST_CASE("modbus: a skill that ends with an acknowledgement ends when the device has acknowledged the write") {
  PlcBench bench;
  bench.connect();
  bench.deliver(MessageType::command, order("reset", ""), "conveyor");
  CHECK(bench.asked() == "write coil 1 1");
  CHECK(bench.told<Outcome>().empty());
  bench.answer_call();
  CHECK(bench.one<Outcome>().outcome == TaskOutcome::finished);
}

TEST_CASE("modbus: a skill whose write is refused has failed, with the device's reason") {
  PlcBench bench;
  bench.connect();
  bench.deliver(MessageType::command, order("run", R"({"speed": 0.5})"), "conveyor");
  bench.asked();
  bench.answer_call(4);
  const Outcome outcome = bench.one<Outcome>();
  CHECK(outcome.outcome == TaskOutcome::failed);
  CHECK(outcome.reason == "speed (holding 0): the device answered 'server device failure' (exception 4)");
}

TEST_CASE("modbus: a stop overtakes what waits, and is answered when the device has taken it") {
  PlcBench bench;
  bench.connect();
  const auto under_way = bench.command("jog", "[0.25, 1]");
  const auto waiting = bench.command("set_speed", "0.5");
  CHECK(bench.asked() == "write holding 0 250");
  const auto id = bench.deliver(MessageType::command, Stop{"fire"});
  CHECK(bench.nack_of(under_way).code == "fenced");
  CHECK(bench.nack_of(under_way).what == "the robot was stopped when the device had acknowledged 0 of its 2 writes");
  CHECK(bench.answer(waiting) == "nack fenced");
  CHECK(bench.asked().empty());  // one call at a time: libmodbus has one connection
  bench.answer_call();
  CHECK(bench.asked() == "write coil 0 0");
  CHECK(bench.answer(id).empty());
  bench.answer_call();
  bench.wait(0.01);
  CHECK(bench.answer(id) == "ack stopped");
  CHECK(bench.serve().empty());
  CHECK(bench.answer(bench.command("set_speed", "0.5")) == "nack fenced");
  CHECK(bench.answer(bench.deliver(MessageType::command, Release{})) == "ack released");
  bench.command("set_speed", "0.5");
  CHECK(bench.serve() == "holding 0 500");
}

TEST_CASE("modbus: a stop comes before the values that are due") {
  PlcBench bench;
  bench.connect();
  bench.wait(0.1);
  CHECK(bench.asked() == "read discrete 3 x1");
  bench.deliver(MessageType::command, Stop{""});
  bench.deliver(MessageType::command, Stop{"again"});
  bench.answer_call(0, {0});
  CHECK(bench.asked() == "write coil 0 0");
  bench.answer_call();
  CHECK(bench.asked() == "read input 0 x3");  // two stops that wait are one
}

TEST_CASE("modbus: a stop that the device refuses is told to everybody and is not called confirmed") {
  PlcBench bench;
  bench.connect();
  const auto id = bench.deliver(MessageType::command, Stop{""});
  bench.asked();
  bench.answer_call(4);
  const RobotFault fault = bench.one<RobotFault>();
  CHECK(fault.severity == Severity::critical);
  CHECK(fault.text.starts_with("the device refused to stop: running (coil 0)"));
  bench.live(2.1);
  CHECK(bench.answer(id) == "nack timeout");
  CHECK(bench.kept.size() == 1);
  bench.deliver(MessageType::command, Stop{""});
  bench.live(0.2);
  CHECK(bench.kept.empty());  // it has stopped after all
}

TEST_CASE(
    "modbus: a device that goes in the middle of a write leaves it open whether it was done; nothing is repeated") {
  PlcBench bench;
  bench.connect();
  const auto under_way = bench.command("jog", "[0.25, 1]");
  const auto waiting = bench.command("set_speed", "0.5");
  bench.asked();
  bench.down(Channel::command, "no answer within 0.5 s");
  CHECK(bench.nack_of(under_way).code == "robot_offline");
  CHECK(bench.nack_of(under_way).what ==
        "the connection was lost while speed (holding 0) was written, and nobody knows whether the device took it: no "
        "answer within 0.5 s");
  CHECK(bench.nack_of(waiting).what.starts_with("the connection was lost before the command was written"));
  CHECK(bench.asked().empty());
  bench.up(Channel::command);
  CHECK(bench.serve().empty());
  CHECK(bench.answer(bench.send(MessageType::request, "speed", "")) == "0");
}

TEST_CASE("modbus: what a device told before it went answers no request") {
  PlcBench bench;
  bench.connect();
  bench.down(Channel::command, "closed by the device");
  CHECK(bench.answer(bench.send(MessageType::request, "speed", "")) == "nack robot_offline");
  bench.up(Channel::command);
  CHECK(bench.answer(bench.send(MessageType::request, "speed", "")) == "nack robot_offline");
}

TEST_CASE("modbus: a skill whose device goes is interrupted, not failed: nobody knows how far it came") {
  PlcBench bench;
  bench.connect();
  bench.deliver(MessageType::command, order("run", R"({"speed": 0.5})"), "conveyor");
  bench.serve();
  bench.live(1);
  bench.down(Channel::command, "closed by the device");
  const Outcome outcome = bench.one<Outcome>();
  CHECK(outcome.outcome == TaskOutcome::interrupted);
  CHECK(outcome.reason == "the robot's connection was lost: closed by the device");
  bench.up(Channel::command);
  CHECK(bench.serve().empty());
}

TEST_CASE("modbus: a robot that was stopped while it was away is stopped when it comes back") {
  PlcBench bench;
  bench.connect();
  bench.down(Channel::command, "closed by the device");
  const auto id = bench.deliver(MessageType::command, Stop{""});
  bench.wait(0.01);
  CHECK(bench.answer(id) == "nack robot_offline");
  bench.up(Channel::command);
  CHECK(bench.serve() == "coil 0 0");
}

TEST_CASE("modbus: a skill that times out is stopped without a fence") {
  PlcBench bench;
  bench.connect();
  bench.deliver(MessageType::command, order("run", R"({"speed": 0.5})"), "conveyor");
  CHECK(bench.serve() == "holding 0 500; coil 0 1");
  bench.live(9.8);
  bench.memory[{ModbusKind::coil, 0}] = 1;
  bench.live(0.3);
  CHECK(bench.one<Outcome>().reason == "timed out after 10 s");
  CHECK(bench.memory[{ModbusKind::coil, 0}] == 0);
  CHECK(bench.answer(bench.command("set_speed", "0.5")).find("fenced") == std::string::npos);
}

TEST_CASE("modbus: a message whose sender waits no more is not written") {
  PlcBench bench;
  bench.connect();
  const auto first = bench.command("set_speed", "0.25");
  bench.remaining_ms = 100;
  const auto second = bench.command("set_speed", "0.5");
  bench.asked();
  bench.wait(0.2);
  CHECK(bench.answer(second) == "nack timeout");
  bench.answer_call();
  CHECK(bench.answer(first) == "ack handed_over");
  CHECK(bench.serve().empty());
}

TEST_CASE("modbus: the queue is bounded, and commands without end do not keep values from being told") {
  PlcBench bench;
  bench.connect();
  for (int i = 0; i < 64; ++i) bench.command("set_speed", "0.5");
  CHECK(bench.answer(bench.command("set_speed", "0.5")) == "nack queue_full");
  bench.wait(0.1);
  bench.asked();
  bench.answer_call();
  CHECK(bench.asked() == "read discrete 3 x1");
  bench.answer_call(0, {0});
  CHECK(bench.asked() == "write holding 0 500");
}

TEST_CASE("modbus: without a value to ask for, a device that has gone is noticed all the same") {
  Settings settings = conveyor();
  settings.commands.requests.clear();
  settings.description.skills.clear();
  PlcBench bench(settings);
  bench.up(Channel::command);
  CHECK(bench.asked() == "read coil 0 x1");
  bench.answer_call(1);
  CHECK(online(bench) == "ONLINE");
  CHECK(bench.told<RobotFault>().empty());
  bench.wait(0.1);
  CHECK(bench.asked() == "read coil 0 x1");
}

TEST_CASE("modbus: answers of another size, or to nothing, do no harm") {
  PlcBench bench;
  bench.up(Channel::command);
  bench.asked();
  bench.answer_call(0, {});
  CHECK(bench.one<RobotFault>().text.find("another size") != std::string::npos);
  bench.serve();
  bench.answer_call(0, {1});
  bench.hear(Channel::command, "");
  bench.hear(Channel::command, "xx");
  CHECK(bench.counted("refused.bad_packet") == 3);
}

TEST_CASE("modbus: calls and answers survive their way to the thread that makes them") {
  const ModbusCall call{true, kHolding, 65535, 0, {1, 65535}};
  const auto back = decode_modbus_call(encode(call));
  REQUIRE(back.has_value());
  CHECK(text_of(*back) == "write holding 65535 1 65535");
  CHECK_FALSE(decode_modbus_call("").has_value());
  CHECK_FALSE(decode_modbus_call(encode(call) + "x").has_value());
  CHECK_FALSE(decode_modbus_call(encode(ModbusCall{false, kHolding, 0, 126, {}})).has_value());
  CHECK(decode_modbus_answer(encode(ModbusAnswer{2, {3}}))->words == std::vector<std::uint16_t>{3});
  CHECK_FALSE(decode_modbus_answer("").has_value());
}
