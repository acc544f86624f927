// The direct mode over Modbus: skills, stops, and a device that goes while something moves.
#include "common/drivers/modbus/test/fixture.hpp"

using namespace trb;
using namespace trb::adapter;

TEST_CASE("modbus: a skill ends when the value is as its description says") {
  OnlinePlc fixture;
  fixture.deliver(MessageType::command, order("run", R"({"speed": 0.5})"), "conveyor");
  CHECK(fixture.serve() == "holding 0 500; coil 0 1");
  fixture.live(3);
  CHECK(fixture.told<Outcome>().empty());
  fixture.memory[{kDiscrete, 3}] = 1;
  fixture.live(0.2);
  CHECK(fixture.one<Outcome>().outcome == TaskOutcome::finished);
}

TEST_CASE("modbus: a skill that ends with an acknowledgement ends when the device has acknowledged the write") {
  OnlinePlc fixture;
  fixture.deliver(MessageType::command, order("reset", ""), "conveyor");
  CHECK(fixture.asked() == "write coil 1 1");
  CHECK(fixture.told<Outcome>().empty());
  fixture.answer_call();
  CHECK(fixture.one<Outcome>().outcome == TaskOutcome::finished);
}

TEST_CASE("modbus: a skill whose write is refused has failed, with the device's reason") {
  OnlinePlc fixture;
  fixture.deliver(MessageType::command, order("run", R"({"speed": 0.5})"), "conveyor");
  fixture.asked();
  fixture.answer_call(4);
  CHECK(fixture.failure() == "speed (holding 0): the device answered 'server device failure' (exception 4)");
}

TEST_CASE("modbus: a stop overtakes what waits, and is answered when the device has taken it") {
  OnlinePlc fixture;
  const auto under_way = fixture.command("jog", "[0.25, 1]");
  const auto waiting = fixture.command("set_speed", "0.5");
  CHECK(fixture.asked() == "write holding 0 250");
  const auto id = fixture.deliver(MessageType::command, Stop{"fire"});
  CHECK(fixture.nack_of(under_way).code == "fenced");
  CHECK(fixture.nack_of(under_way).what == "the robot was stopped when the device had acknowledged 0 of its 2 writes");
  CHECK(fixture.answer(waiting) == "nack fenced");
  CHECK(fixture.asked().empty());  // one call at a time: libmodbus has one connection
  fixture.answer_call();
  CHECK(fixture.asked() == "write coil 0 0");
  CHECK(fixture.answer(id).empty());
  fixture.answer_call();
  fixture.wait(0.01);
  CHECK(fixture.answer(id) == "ack stopped");
  CHECK(fixture.serve().empty());
  CHECK(fixture.answer(fixture.command("set_speed", "0.5")) == "nack fenced");
  CHECK(fixture.answer(fixture.deliver(MessageType::command, Release{})) == "ack released");
  fixture.command("set_speed", "0.5");
  CHECK(fixture.serve() == "holding 0 500");
}

TEST_CASE("modbus: a stop comes before the values that are due") {
  OnlinePlc fixture;
  fixture.wait(0.1);
  CHECK(fixture.asked() == "read discrete 3 x1");
  fixture.deliver(MessageType::command, Stop{""});
  fixture.deliver(MessageType::command, Stop{"again"});
  fixture.answer_call(0, {0});
  CHECK(fixture.asked() == "write coil 0 0");
  fixture.answer_call();
  CHECK(fixture.asked() == "read input 0 x3");  // two stops that wait are one
}

TEST_CASE("modbus: a stop that the device refuses is told to everybody and is not called confirmed") {
  OnlinePlc fixture;
  const auto id = fixture.deliver(MessageType::command, Stop{""});
  fixture.asked();
  fixture.answer_call(4);
  const RobotFault fault = fixture.one<RobotFault>();
  CHECK(fault.severity == Severity::critical);
  CHECK(fault.text.starts_with("the device refused to stop: running (coil 0)"));
  fixture.wait(0.01);
  CHECK(fixture.answer(id) == "nack robot_error");
  CHECK(fixture.kept.size() == 1);
  fixture.deliver(MessageType::command, Stop{""});
  fixture.live(0.2);
  CHECK(fixture.kept.empty());  // it has stopped after all
}

TEST_CASE(
    "modbus: a device that goes in the middle of a write leaves it open whether it was done; nothing is repeated") {
  OnlinePlc fixture;
  const auto under_way = fixture.command("jog", "[0.25, 1]");
  const auto waiting = fixture.command("set_speed", "0.5");
  fixture.asked();
  fixture.down(Channel::command, "no answer within 0.5 s");
  CHECK(fixture.nack_of(under_way).code == "robot_offline");
  CHECK(fixture.nack_of(under_way).what ==
        "the connection was lost while speed (holding 0) was written, and nobody knows whether the device took it: no "
        "answer within 0.5 s");
  CHECK(fixture.nack_of(waiting).what.starts_with("the connection was lost before the command was written"));
  CHECK(fixture.asked().empty());
  fixture.up(Channel::command);
  CHECK(fixture.serve().empty());
  CHECK(fixture.answer(fixture.send(MessageType::request, "speed", "")) == "0");
}

TEST_CASE("modbus: what a device told before it went answers no request") {
  OnlinePlc fixture;
  fixture.down(Channel::command, "closed by the device");
  CHECK(fixture.answer(fixture.send(MessageType::request, "speed", "")) == "nack robot_offline");
  fixture.up(Channel::command);
  CHECK(fixture.answer(fixture.send(MessageType::request, "speed", "")) == "nack robot_offline");
}

TEST_CASE("modbus: a skill whose device goes is interrupted, not failed; it is halted when the device is back") {
  OnlinePlc fixture;
  fixture.deliver(MessageType::command, order("run", R"({"speed": 0.5})"), "conveyor");
  fixture.serve();
  fixture.live(1);
  fixture.down(Channel::command, "closed by the device");
  const Outcome outcome = fixture.one<Outcome>();
  CHECK(outcome.outcome == TaskOutcome::interrupted);
  CHECK(outcome.reason == "the robot's connection was lost: closed by the device");
  fixture.up(Channel::command);
  CHECK(fixture.serve() == "coil 0 0");
}

TEST_CASE("modbus: a robot that was stopped while it was away is stopped when it comes back") {
  OnlinePlc fixture;
  fixture.down(Channel::command, "closed by the device");
  const auto id = fixture.deliver(MessageType::command, Stop{""});
  fixture.wait(0.01);
  CHECK(fixture.answer(id) == "nack robot_offline");
  fixture.up(Channel::command);
  CHECK(fixture.serve() == "coil 0 0");
}

TEST_CASE("modbus: a skill that times out is stopped without a fence") {
  OnlinePlc fixture;
  fixture.deliver(MessageType::command, order("run", R"({"speed": 0.5})"), "conveyor");
  CHECK(fixture.serve() == "holding 0 500; coil 0 1");
  fixture.live(9.8);
  fixture.memory[{ModbusKind::coil, 0}] = 1;
  fixture.live(0.8);
  CHECK(fixture.one<Outcome>().reason == "timed out after 10 s");
  CHECK(fixture.memory[{ModbusKind::coil, 0}] == 0);
  CHECK(fixture.answer(fixture.command("set_speed", "0.5")).find("fenced") == std::string::npos);
}

TEST_CASE("modbus: a skill is halted once the device has acknowledged it; if it refuses, nobody knows") {
  for (const std::uint8_t exception : std::initializer_list<std::uint8_t>{0, 4}) {
    OnlinePlc fixture;
    fixture.begin_run();
    fixture.cancel_run();
    CHECK(fixture.asked() == "write coil 0 0");
    CHECK(fixture.told<Outcome>().empty());
    fixture.answer_call(exception);
    fixture.wait(0.5);
    const auto outcome = fixture.one<Outcome>();
    CHECK(outcome.outcome == (exception == 0 ? TaskOutcome::failed : TaskOutcome::interrupted));
    CHECK(outcome.reason.starts_with("cancelled: enough"));
  }
}

TEST_CASE("modbus: a device that was halted is released, again if that is lost, before it gets anything else") {
  Settings settings = conveyor();
  settings.commands.commands["release"] = "coil 2 = true";
  for (const bool lost : {false, true}) {
    PlcFixture fixture(settings);
    fixture.connect();
    fixture.begin_run();
    fixture.cancel_run();
    CHECK(fixture.asked() == "write coil 0 0");
    fixture.answer_call();
    fixture.live(0.45);
    fixture.wait(0.05);
    CHECK(fixture.asked() == "write coil 2 1");
    if (lost) {
      fixture.down(Channel::command, "no answer in time");
      fixture.connect();
      fixture.live(0.5);
      CHECK(fixture.memory[{ModbusKind::coil, 2}] == 1);
    } else {
      fixture.answer_call();
    }
    fixture.flags = kFlagTakeControl;
    fixture.command("set_speed", "0.5");
    CHECK(fixture.serve() == "holding 0 500");
  }
}

TEST_CASE(
    "modbus: a release that a device in no stop refuses is no fault; of one that may stand in its stop it is one") {
  Settings settings = conveyor();
  settings.commands.commands["stop"] = "running = 0\ncoil 2 = false";
  settings.commands.commands["release"] = "coil 2 = true";
  PlcFixture fixture(settings);
  fixture.connect();
  fixture.begin_run();
  fixture.deliver(MessageType::command, Release{}, "operator");
  fixture.asked();
  fixture.answer_call(4);
  CHECK(fixture.told<RobotFault>().empty());
  CHECK(fixture.told<Outcome>().empty());
  fixture.cancel_run();
  CHECK(fixture.asked() == "write coil 0 0");
  fixture.answer_call();
  CHECK(fixture.asked() == "write coil 2 0");
  fixture.answer_call(4);
  CHECK(fixture.one<RobotFault>().text.ends_with("; it may stand in its stop: stop and release it"));
  fixture.deliver(MessageType::command, Release{}, "operator");
  CHECK(fixture.asked() == "write coil 2 1");
  fixture.answer_call(4);
  CHECK(fixture.told<RobotFault>().size() == 1);
}

TEST_CASE("modbus: a halt whose answer is lost with the connection is written again before anything else") {
  OnlinePlc fixture;
  fixture.begin_run();
  fixture.cancel_run();
  CHECK(fixture.asked() == "write coil 0 0");
  fixture.down(Channel::command, "no answer in time");
  CHECK(fixture.one<Outcome>().outcome == TaskOutcome::interrupted);
  fixture.up(Channel::command);
  CHECK(fixture.serve() == "coil 0 0");
  fixture.live(0.5);
  CHECK(fixture.answer(fixture.deliver(MessageType::command, order("run", R"({"speed": 0.5})", 2), "conveyor")) ==
        "running");
}
