// The direct mode over Modbus: what is read and written, and what the device answers.
#include "common/drivers/modbus/test/fixture.hpp"

using namespace trb;
using namespace trb::adapter;

TEST_CASE("modbus: what requests and skills' ends need is asked for, neighbours in one call") {
  PlcFixture fixture;
  fixture.up(Channel::command);
  std::string calls = fixture.asked();
  for (int i = 0; i < 2; ++i) {
    fixture.answer_call(0, fixture.registers_of(fixture.waiting));
    calls += "; " + fixture.asked();
  }
  CHECK(calls == "read discrete 3 x1; read input 0 x3; read holding 0 x1");
  fixture.answer_call(0, {250});
  CHECK(fixture.asked().empty());
  fixture.wait(0.09);
  CHECK(fixture.asked().empty());
  fixture.wait(0.01);
  CHECK(fixture.asked() == "read discrete 3 x1");
}

TEST_CASE("modbus: a connection alone is no robot: it counts once it has answered") {
  PlcFixture fixture;
  fixture.up(Channel::command);
  CHECK(online(fixture) == "OFFLINE");
  CHECK(fixture.answer(fixture.command("set_speed", "0.25")) == "nack robot_offline");
  fixture.asked();
  fixture.answer_call(2);  // even an exception shows that the device is there
  CHECK(online(fixture) == "ONLINE");
}

TEST_CASE("modbus: a command writes its registers in their order and is answered once the device has taken all") {
  OnlinePlc fixture;
  const auto id = fixture.command("jog", "[0.25, true]");
  CHECK(fixture.asked() == "write holding 0 250");
  CHECK(fixture.answer(id).empty());
  fixture.answer_call();
  CHECK(fixture.asked() == "write coil 0 1");
  CHECK(fixture.answer(id).empty());
  fixture.answer_call();
  CHECK(fixture.answer(id) == "ack handed_over");
  CHECK(fixture.counted("to_robot.jog") == 1);
  CHECK(fixture.counted("from_robot.done") == 1);
}

TEST_CASE("modbus: two commands at once are written one after the other, none is lost or mixed") {
  OnlinePlc fixture;
  const auto first = fixture.command("jog", "[0.25, 1]");
  const auto second = fixture.command("jog", "[0.5, 0]");
  CHECK(fixture.serve() == "holding 0 250; coil 0 1; holding 0 500; coil 0 0");
  CHECK(fixture.answer(first) == "ack handed_over");
  CHECK(fixture.answer(second) == "ack handed_over");
}

TEST_CASE("modbus: data is numbers; anything else is refused before something is written") {
  OnlinePlc fixture;
  const std::vector<std::pair<std::string, std::string>> cases = {
      {R"("0.25")", "the data holds a text '0.25', and Modbus carries numbers only"},
      {R"("x\" = 1\nrunning = 1")", "Modbus carries numbers only"},
      {"0.25\nrunning = 1", "the data is no JSON"},
      {"0.25\"", "the data is no JSON"},
      {"", "speed needs data, and there is none"},
      {"[0.25, 1]", "speed needs one number, and the data has 2 items"},
      {"[]", "the data has 0 items"},
      {"{}", "the data holds an object"},
      {"null", "the data holds null"},
      {"70", "speed (holding 0): 70 does not fit holding 0, a uint16"},
      {"-0.001", "does not fit"},
  };
  for (const auto& [data, what] : cases) {
    const std::string given = data;
    CAPTURE(given);
    const auto id = fixture.command("set_speed", data);
    CHECK(fixture.nack_of(id).code == "bad_value");
    CHECK_MESSAGE(fixture.nack_of(id).what.find(what) != std::string::npos, fixture.nack_of(id).what);
    CHECK_FALSE(fixture.nack_of(id).hint.empty());
  }
  const auto missing = fixture.command("jog", "[0.25]");
  CHECK(fixture.nack_of(missing).what == "running takes {1}, which needs 2 items, and the data has 1 item");
  const auto surplus = fixture.command("jog", "[0.25, 1, 99]");
  CHECK(fixture.nack_of(surplus).what == "the command takes 2 items, and the data has 3 items");
  CHECK(fixture.asked().empty());
}

TEST_CASE("modbus: an exception names the register, itself and the cure, and the rest is not written") {
  OnlinePlc fixture;
  const auto id = fixture.command("run", "0.25");
  fixture.asked();
  fixture.answer_call(3);
  CHECK(fixture.nack_of(id).code == "robot_error");
  CHECK(fixture.nack_of(id).what == "speed (holding 0): the device answered 'illegal data value' (exception 3)");
  CHECK(fixture.nack_of(id).hint == "give a value within the limits of the device's manual");
  CHECK(fixture.asked().empty());
  const auto second = fixture.command("run", "0.25");
  fixture.asked();
  fixture.answer_call();
  fixture.asked();
  fixture.answer_call(6);
  CHECK(fixture.nack_of(second).what ==
        "running (coil 0): the device answered 'server device busy' (exception 6); the 1 writes before it were done");
}

TEST_CASE("modbus: a request is answered with what the device last told") {
  PlcFixture fixture;
  fixture.memory[{kHolding, 0}] = 250;
  fixture.memory[{kInput, 0}] = 1234;
  fixture.memory[{kInput, 1}] = 1;
  fixture.connect();
  CHECK(fixture.answer(fixture.send(MessageType::request, "speed", "")) == "0.25");
  CHECK(fixture.answer(fixture.send(MessageType::request, "position", "")) == "1.234");
  CHECK(fixture.answer(fixture.send(MessageType::request, "boxes", "")) == "65536");
  fixture.memory[{kInput, 0}] = 1500;
  fixture.live(0.15);
  CHECK(fixture.answer(fixture.send(MessageType::request, "position", "")) == "1.5");
}

TEST_CASE("modbus: a value that the device does not have is told once as a warning, and the others go on") {
  PlcFixture fixture;
  fixture.up(Channel::command);
  const auto refuse_position = [&] {
    for (std::string call = fixture.asked(); !call.empty(); call = fixture.asked()) {
      const bool with_position = fixture.waiting.kind == kInput && fixture.waiting.address == 0;
      fixture.answer_call(with_position ? 2 : 0,
                          with_position ? std::vector<std::uint16_t>{} : fixture.registers_of(fixture.waiting));
    }
  };
  refuse_position();
  const RobotFault fault = fixture.one<RobotFault>();
  CHECK(fault.capability == "convey");
  CHECK(fault.severity == Severity::warning);
  CHECK(fault.text.starts_with("position (input 0): the device answered 'illegal data address' (exception 2); look"));
  CHECK(fixture.answer(fixture.send(MessageType::request, "boxes", "")) == "0");
  const auto id = fixture.send(MessageType::request, "position", "");
  CHECK(fixture.nack_of(id).code == "robot_error");
  CHECK(fixture.nack_of(id).what == "position (input 0): the device answered 'illegal data address' (exception 2)");
  for (int i = 0; i < 20; ++i) {
    fixture.wait(0.1);
    refuse_position();
  }
  CHECK(fixture.told<RobotFault>().empty());
  fixture.live(0.1);  // the device has it again
  CHECK(fixture.answer(fixture.send(MessageType::request, "position", "")) == "0");
  fixture.wait(0.1);
  refuse_position();
  CHECK(fixture.told<RobotFault>().size() == 1);
}

TEST_CASE("modbus: a message whose sender waits no more is not written") {
  OnlinePlc fixture;
  const auto first = fixture.command("set_speed", "0.25");
  fixture.remaining_ms = 100;
  const auto second = fixture.command("set_speed", "0.5");
  fixture.asked();
  fixture.wait(0.2);
  CHECK(fixture.answer(second) == "nack timeout");
  fixture.answer_call();
  CHECK(fixture.answer(first) == "ack handed_over");
  CHECK(fixture.serve().empty());
}

TEST_CASE("modbus: the queue is bounded, and commands without end do not keep values from being told") {
  OnlinePlc fixture;
  for (int i = 0; i < 64; ++i) fixture.command("set_speed", "0.5");
  CHECK(fixture.answer(fixture.command("set_speed", "0.5")) == "nack queue_full");
  fixture.wait(0.1);
  fixture.asked();
  fixture.answer_call();
  CHECK(fixture.asked() == "read discrete 3 x1");
  fixture.answer_call(0, {0});
  CHECK(fixture.asked() == "write holding 0 500");
}

TEST_CASE("modbus: without a value to ask for, a device that has gone is noticed all the same") {
  Settings settings = conveyor();
  settings.commands.requests.clear();
  settings.description.skills.clear();
  PlcFixture fixture(settings);
  fixture.up(Channel::command);
  CHECK(fixture.asked() == "read coil 0 x1");
  fixture.answer_call(1);
  CHECK(online(fixture) == "ONLINE");
  CHECK(fixture.told<RobotFault>().empty());
  fixture.wait(0.1);
  CHECK(fixture.asked() == "read coil 0 x1");
}

TEST_CASE("modbus: answers of another size, or to nothing, do no harm") {
  PlcFixture fixture;
  fixture.up(Channel::command);
  fixture.asked();
  fixture.answer_call(0, {});
  CHECK(fixture.one<RobotFault>().text.find("another size") != std::string::npos);
  fixture.serve();
  fixture.answer_call(0, {1});
  fixture.hear(Channel::command, "");
  fixture.hear(Channel::command, "xx");
  CHECK(fixture.counted("refused.bad_packet") == 3);
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

TEST_CASE("modbus: a device that is busy for a second is polled as before, and no value is a fault of its own") {
  OnlinePlc fixture;
  const auto answer_all = [&](std::uint8_t exception) {
    std::string calls;
    for (std::string call = fixture.asked(); !call.empty(); call = fixture.asked()) {
      calls += call + "; ";
      fixture.answer_call(exception,
                          exception == 0 ? fixture.registers_of(fixture.waiting) : std::vector<std::uint16_t>{});
    }
    return calls;
  };
  const std::string round = "read discrete 3 x1; read input 0 x3; read holding 0 x1; ";
  for (int i = 0; i < 10; ++i) {
    fixture.wait(0.1);
    CHECK(answer_all(6) == round);
  }
  CHECK(fixture.told<RobotFault>().empty());
  CHECK(fixture.answer(fixture.send(MessageType::request, "position", "")) == "nack robot_error");
  fixture.wait(0.1);
  CHECK(answer_all(0) == round);
  CHECK(fixture.answer(fixture.send(MessageType::request, "position", "")) == "0");
  for (int i = 0; i < 40; ++i) {
    fixture.wait(0.1);
    answer_all(4);
  }
  const auto faults = fixture.told<RobotFault>();
  REQUIRE(faults.size() == 3);  // one of each call
  CHECK(get<RobotFault>(faults[1].body)
            .text.starts_with("2 values (position, boxes): the device answered 'server device failure' (exception 4)"));
}

TEST_CASE("modbus: values that were read alone are read together again on the next connection") {
  OnlinePlc fixture;
  fixture.wait(0.1);
  CHECK(fixture.asked() == "read discrete 3 x1");
  fixture.answer_call(0, {0});
  CHECK(fixture.asked() == "read input 0 x3");
  fixture.answer_call(2);
  CHECK(fixture.asked() == "read input 0 x1");
  fixture.down(Channel::command, "closed by the device");
  fixture.up(Channel::command);
  CHECK(fixture.asked() == "read discrete 3 x1");
  fixture.answer_call(0, {0});
  CHECK(fixture.asked() == "read input 0 x3");
}
