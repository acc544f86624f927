// The direct mode over Modbus: how long a halt is held, and what becomes of a stop that is refused.
#include "common/drivers/modbus/test/fixture.hpp"

using namespace trb;
using namespace trb::adapter;

namespace {

/// A bit requests the stop, and is taken back to go on.
Settings with_stop_bit() {
  Settings settings = conveyor();
  settings.commands.commands["stop"] = "coil 6 = true";
  settings.commands.commands["release"] = "coil 6 = false";
  return settings;
}

struct StopBitPlc : PlcFixture {
  explicit StopBitPlc(Settings settings = with_stop_bit()) : PlcFixture(std::move(settings)) { connect(); }
};

/// Its stop has two lines.
struct TwoLinesPlc : PlcFixture {
  TwoLinesPlc() : PlcFixture(settings()) { connect(); }
  static Settings settings() {
    Settings settings = with_stop_bit();
    settings.commands.commands["stop"] = "running = 0\ncoil 6 = true";
    return settings;
  }
};

}  // namespace

TEST_CASE("modbus: a halt is held, so that a PLC with a cycle sees it, before it is taken back and called done") {
  StopBitPlc fixture;
  fixture.begin_run();
  fixture.cancel_run();
  CHECK(fixture.serve() == "coil 6 1");
  fixture.wait(0.1);
  CHECK(fixture.asked() == "read discrete 3 x1");  // its values are polled meanwhile
  fixture.answer_call(0, {0});
  fixture.serve();
  fixture.wait(0.35);
  CHECK(fixture.serve().empty());
  CHECK(fixture.told<Outcome>().empty());
  fixture.wait(0.05);
  CHECK(fixture.one<Outcome>().outcome == TaskOutcome::failed);
  CHECK(fixture.serve() == "coil 6 0");
}

TEST_CASE("modbus: commands.json tells how long a halt is held") {
  for (const double hold_s : {0.0, 2.0}) {
    Settings settings = with_stop_bit();
    settings.commands.numbers["hold_s"] = hold_s;
    StopBitPlc fixture(settings);
    fixture.begin_run();
    fixture.cancel_run();
    CHECK(fixture.serve() == (hold_s == 0 ? "coil 6 1; coil 6 0" : "coil 6 1"));
    fixture.wait(1.95);
    CHECK(fixture.serve().empty());
    fixture.wait(0.05);
    CHECK(fixture.serve() == (hold_s == 0 ? "" : "coil 6 0"));
    CHECK_FALSE(fixture.told<Outcome>().empty());
  }
}

TEST_CASE("modbus: a command and a release wait until a halt was held") {
  StopBitPlc fixture;
  fixture.begin_run();
  fixture.cancel_run();
  fixture.serve();
  fixture.flags = kFlagTakeControl;
  fixture.command("set_speed", "0.5");
  fixture.deliver(MessageType::command, Release{}, "operator");
  CHECK(fixture.serve().empty());
  fixture.wait(0.5);
  CHECK(fixture.serve() == "coil 6 0; holding 0 500");
}

TEST_CASE("modbus: a stop does not wait until a halt was held, and stays") {
  StopBitPlc fixture;
  fixture.begin_run();
  fixture.cancel_run();
  CHECK(fixture.serve() == "coil 6 1");
  fixture.deliver(MessageType::command, Stop{}, "operator");
  CHECK(fixture.serve() == "coil 6 1");
  fixture.live(2);
  CHECK(fixture.memory[{ModbusKind::coil, 6}] == 1);
}

TEST_CASE("modbus: a device that goes while a halt is held is halted and released when it is back") {
  StopBitPlc fixture;
  fixture.begin_run();
  fixture.cancel_run();
  fixture.serve();
  fixture.down(Channel::command, "closed by the device");
  fixture.up(Channel::command);
  CHECK(fixture.serve() == "coil 6 1");
  fixture.live(0.5);
  CHECK(fixture.memory[{ModbusKind::coil, 6}] == 0);
}

TEST_CASE("modbus: a stop attempts each of its lines, and says then which was refused") {
  TwoLinesPlc fixture;
  const auto id = fixture.deliver(MessageType::command, Stop{});
  CHECK(fixture.asked() == "write coil 0 0");
  fixture.answer_call(4);
  CHECK(fixture.asked() == "write coil 6 1");
  CHECK(fixture.told<RobotFault>().empty());
  fixture.answer_call();
  const std::string why =
      "running (coil 0): the device answered 'server device failure' (exception 4); 1 of its 2 writes was done";
  CHECK(fixture.one<RobotFault>().text == "the device refused to stop: " + why);
  fixture.wait(0.01);
  CHECK(fixture.nack_of(id).what == "the node is fenced, but the robot refused to stop: " + why);
}

TEST_CASE("modbus: a halt attempts each of its lines, too, and is released if one was taken") {
  TwoLinesPlc fixture;
  fixture.begin_run();
  fixture.cancel_run();
  CHECK(fixture.asked() == "write coil 0 0");
  fixture.answer_call(4);
  CHECK(fixture.asked() == "write coil 6 1");
  fixture.answer_call();
  CHECK(fixture.one<Outcome>().outcome == TaskOutcome::interrupted);
  CHECK(fixture.one<RobotFault>().text.ends_with("; it may stand in its stop: stop and release it"));
}

TEST_CASE("modbus: a refused stop is answered at once, with the reason") {
  OnlinePlc fixture;
  const auto id = fixture.deliver(MessageType::command, Stop{});
  fixture.asked();
  fixture.answer_call(4);
  fixture.wait(0.01);
  CHECK(fixture.nack_of(id).code == "robot_error");
  CHECK(fixture.nack_of(id).what ==
        "the node is fenced, but the robot refused to stop: running (coil 0): the device answered 'server device "
        "failure' (exception 4)");
}

TEST_CASE("modbus: a refused stop is written again every second while the node is fenced, and told once") {
  OnlinePlc fixture;
  fixture.deliver(MessageType::command, Stop{});
  for (int i = 0; i < 3; ++i) {
    CHECK(fixture.asked() == "write coil 0 0");
    fixture.answer_call(4);
    fixture.wait(0.95);
    CHECK(fixture.serve().empty());
    fixture.wait(0.05);
  }
  CHECK(fixture.told<RobotFault>().size() == 1);
  CHECK(fixture.serve() == "coil 0 0");
  CHECK(fixture.kept.empty());  // it has stopped after all
  fixture.live(3);
  CHECK(fixture.counted("to_robot.stop_again") == 3);
}

TEST_CASE("modbus: a refused stop is not written again after the release") {
  OnlinePlc fixture;
  fixture.deliver(MessageType::command, Stop{});
  fixture.asked();
  fixture.answer_call(4);
  fixture.wait(0.01);
  CHECK(fixture.answer(fixture.deliver(MessageType::command, Release{})) == "ack released");
  fixture.wait(2);
  CHECK(fixture.serve().empty());
  fixture.deliver(MessageType::command, Stop{});
  fixture.asked();
  fixture.deliver(MessageType::command, Release{});
  fixture.answer_call(4);
  fixture.wait(2);
  CHECK(fixture.serve().empty());
}

TEST_CASE("modbus: another stop does not wait for the next attempt of a refused one") {
  OnlinePlc fixture;
  fixture.deliver(MessageType::command, Stop{});
  fixture.asked();
  fixture.answer_call(4);
  fixture.wait(0.2);
  fixture.serve();
  const auto id = fixture.deliver(MessageType::command, Stop{"again"});
  CHECK(fixture.asked() == "write coil 0 0");
  fixture.answer_call(4);
  fixture.wait(0.01);
  CHECK(fixture.answer(id) == "nack robot_error");
}

TEST_CASE("modbus: a stop or a halt that finds the device busy is written again until the device is free") {
  for (const std::uint8_t busy : std::initializer_list<std::uint8_t>{5, 6}) {
    for (const bool halt : {false, true}) {
      OnlinePlc fixture;
      fixture.begin_run();
      std::uint64_t id = 0;
      if (halt) fixture.cancel_run();
      if (!halt) id = fixture.deliver(MessageType::command, Stop{});
      for (int i = 0; i < 6; ++i) {
        CHECK(fixture.asked() == "write coil 0 0");
        fixture.answer_call(busy);
        fixture.serve();  // the values, which are polled meanwhile
        fixture.wait(0.1);
      }
      CHECK(fixture.told<RobotFault>().empty());
      CHECK(fixture.serve() == "coil 0 0");
      fixture.wait(0.5);
      if (halt) CHECK(fixture.one<Outcome>().outcome == TaskOutcome::failed);
      if (!halt) CHECK(fixture.answer(id) == "ack stopped");
    }
  }
}

TEST_CASE("modbus: a stop that finds the device busy for long is called refused, and goes on") {
  OnlinePlc fixture;
  const auto id = fixture.deliver(MessageType::command, Stop{});
  for (int i = 0; i < 30; ++i) {
    CHECK(fixture.asked() == "write coil 0 0");
    fixture.answer_call(6);
    CHECK(fixture.told<RobotFault>().size() == (i == 15 ? 1 : 0));
    fixture.serve();
    fixture.wait(0.1);
  }
  CHECK(fixture.nack_of(id).what.find("'server device busy' (exception 6)") != std::string::npos);
  CHECK(fixture.serve() == "coil 0 0");
  CHECK(fixture.kept.empty());
}

TEST_CASE("modbus: a state of before the command ends no skill") {
  OnlinePlc fixture;
  fixture.memory[{kDiscrete, 3}] = 1;
  fixture.live(0.2);
  fixture.begin_run();
  fixture.live(1);  // the PLC takes its time to begin
  CHECK(fixture.told<Outcome>().empty());
  fixture.memory[{kDiscrete, 3}] = 0;
  fixture.live(0.2);
  fixture.memory[{kDiscrete, 3}] = 1;
  fixture.live(0.2);
  CHECK(fixture.one<Outcome>().outcome == TaskOutcome::finished);
}

TEST_CASE("modbus: a state that stays for two seconds after the command is that of the skill") {
  OnlinePlc fixture;
  fixture.memory[{kDiscrete, 3}] = 1;
  fixture.live(0.2);
  fixture.begin_run();
  fixture.live(1.9);
  CHECK(fixture.told<Outcome>().empty());
  fixture.live(0.2);
  CHECK(fixture.one<Outcome>().outcome == TaskOutcome::finished);
}
