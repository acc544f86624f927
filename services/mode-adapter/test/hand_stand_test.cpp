// A robot that is driven by hand is told to stand, whatever ends: its link, a stop, the process.
#include "common/drivers/modbus/test/fixture.hpp"
#include "services/mode-adapter/test/hand_fixture.hpp"

using namespace trb;
using namespace trb::adapter;

namespace {

Settings driven_conveyor() {
  Settings settings = conveyor();
  settings.description.drives = {base_drive("[{x}, {yaw}]")};
  settings.description.drives[0].axes.resize(1);
  settings.description.drives[0].command.parameters.resize(1);
  settings.description.drives[0].command.data = "{x}";
  settings.commands.commands["drive"] = "speed = {data}";
  return settings;
}

Settings driven_pioneer() {
  Settings settings = pioneer();
  settings.description.drives = {base_drive("{x} {yaw}")};
  return settings;
}

Velocity first_speed() {
  return {DrivePart::base, {0.2}, 1, 1, false, false, "ada"};
}

}  // namespace

TEST_CASE("a robot whose link was lost is told to stand as soon as it is back") {
  HandFixture fixture;
  fixture.drive({0.2});
  fixture.sent();
  fixture.down(Channel::command);
  CHECK(fixture.drive({0.2}, fixture.another(2)) == "nack robot_offline");
  fixture.up(Channel::command);
  CHECK(fixture.sent() == "SPEED 0 0\n");
  CHECK(fixture.drive({0.2}) == "nack conflict");
  fixture.down(Channel::command);
  fixture.up(Channel::command);
  CHECK(fixture.sent().empty());  // once
}

TEST_CASE("a process that ends has its robot stand") {
  HandFixture fixture;
  fixture.drive({0.2});
  fixture.sent();
  CHECK_FALSE(fixture.may_be_replaced());
  fixture.core.leave(fixture.now, fixture.out);
  CHECK(fixture.sent() == "SPEED 0 0\n");
}

TEST_CASE("a process that ends waits until the robot has the order to stand: a device that owes an answer first") {
  PlcFixture fixture(driven_conveyor());
  fixture.connect();
  fixture.deliver(MessageType::command, first_speed(), "cloud");
  CHECK(fixture.serve() == "holding 0 200");
  while (fixture.asked().empty()) fixture.wait(0.01);  // a poll is under way
  CHECK_FALSE(fixture.waiting.write);
  fixture.core.begin_leave(fixture.now, fixture.out);
  CHECK_FALSE(fixture.core.may_leave());
  CHECK(fixture.asked().empty());
  fixture.answer_call(0, fixture.registers_of(fixture.waiting));
  CHECK(fixture.asked() == "write holding 0 0");
  CHECK_FALSE(fixture.core.may_leave());
  fixture.answer_call();
  CHECK(fixture.core.may_leave());
}

TEST_CASE("a process that ends waits until the robot has the order to stand: a robot that acknowledges each field") {
  Fixture fixture(driven_pioneer());
  fixture.up(Channel::field);
  fixture.deliver(MessageType::command, first_speed(), "cloud");
  fixture.take_fields();
  fixture.core.begin_leave(fixture.now, fixture.out);
  CHECK_FALSE(fixture.core.may_leave());
  CHECK(fixture.take_fields(4).find("drive\n") != std::string::npos);
  CHECK_FALSE(fixture.core.may_leave());
  CHECK(fixture.take_fields(1) == "0 0\n");
  CHECK(fixture.core.may_leave());
}

TEST_CASE("a stop that did not reach the robot does not stand for the order to stand") {
  HandFixture fixture;
  fixture.drive({0.2});
  fixture.sent();
  fixture.down(Channel::command);
  const auto stop = fixture.deliver(MessageType::command, Stop{"test"}, "ur3");
  fixture.wait(0.01);
  CHECK(fixture.answer(stop) == "nack robot_offline");
  fixture.deliver(MessageType::command, Release{}, "ur3");
  fixture.up(Channel::command);
  CHECK(fixture.sent() == "SPEED 0 0\n");
  fixture.down(Channel::command);
  fixture.up(Channel::command);
  CHECK(fixture.sent().empty());
}

TEST_CASE("a stop that was lost on its way does not stand for the order to stand; one that was confirmed does") {
  for (const bool confirmed : {false, true}) {
    PlcFixture fixture(driven_conveyor());
    fixture.connect();
    fixture.deliver(MessageType::command, first_speed(), "cloud");
    fixture.serve();
    fixture.deliver(MessageType::command, Stop{"test"}, "ur3");
    CHECK(fixture.asked() == "write coil 0 0");
    if (confirmed) fixture.answer_call();
    fixture.down(Channel::command);
    fixture.deliver(MessageType::command, Release{}, "ur3");
    fixture.up(Channel::command);
    const bool stands = fixture.serve().find("holding 0 0") != std::string::npos;
    CHECK(stands != confirmed);
  }
}

TEST_CASE("a process that ends begins nothing more; it stops its robot, if it is told to") {
  HandFixture fixture;
  fixture.core.begin_leave(fixture.now, fixture.out);
  CHECK(fixture.core.may_leave());
  CHECK(fixture.drive({0.2}) == "nack robot_offline");
  CHECK(fixture.answer(fixture.command("go", "1")) == "nack robot_offline");
  CHECK(fixture.answer(fixture.deliver(MessageType::request, order("home", ""), "cart")) == "nack robot_offline");
  CHECK(fixture.sent().empty());
  fixture.deliver(MessageType::command, Stop{"test"});
  CHECK(fixture.sent() == "HALT\n");
}

TEST_CASE("a robot that was lost before it was told to stand is waited for") {
  HandFixture fixture;
  fixture.drive({0.2});
  fixture.down(Channel::command);
  fixture.core.begin_leave(fixture.now, fixture.out);
  CHECK_FALSE(fixture.core.may_leave());
  fixture.sent();
  fixture.up(Channel::command);
  CHECK(fixture.sent() == "SPEED 0 0\n");
  CHECK(fixture.core.may_leave());
}
