// Driving by hand: speeds go to the robot as long as they come; when they cease, the robot stands.
#include "services/mode-adapter/core/hand_drive.hpp"

#include <limits>

#include "common/drivers/modbus/test/fixture.hpp"
#include "services/mode-adapter/test/fixture.hpp"

using namespace trb;
using namespace trb::adapter;

namespace {

Drive base_drive(const std::string& data) {
  Drive drive;
  drive.part = DrivePart::base;
  drive.axes = {{"x", 0.5, false, {}}, {"yaw", 1, false, {}}};
  drive.command = make_skill(
      "drive", data,
      {make_parameter("x", ParameterType::number, "m/s"), make_parameter("yaw", ParameterType::number, "rad/s")});
  return drive;
}

/// A robot of a maker that takes every line at once (tcp-text without a monitor): what is written has left.
Settings driven_cart() {
  Settings settings = robot_settings("cart", "acme", Mode::direct, "tcp-text");
  settings.description.capabilities = {"mobile"};
  settings.description.skills = {make_skill("home", "")};
  settings.description.skills[0].end.kind = EndKind::time;
  settings.description.skills[0].end.duration_s = 5;
  settings.description.drives = {base_drive("[{x}, {yaw}]")};
  settings.description.frame.length = 1000;
  settings.commands.port = 30100;
  settings.commands.commands = {
      {"drive", "SPEED {0} {1}"}, {"go", "GO {data}"}, {"home", "HOME"}, {"stop", "HALT"}, {"release", ""}};
  return settings;
}

struct HandFixture : Fixture {
  explicit HandFixture(Settings settings = driven_cart()) : Fixture(std::move(settings)) {
    up(Channel::command);
    welcome();
    out.clear();
  }
  /// A drive's next message; its answer.
  std::string drive(std::vector<double> speeds, Velocity how = {}, const std::string& source = "cloud") {
    how.part = how.part == DrivePart::base ? part : how.part;
    how.speeds = std::move(speeds);
    if (how.drive == 0) how.drive = 1;
    if (how.sequence == 0) how.sequence = ++sequence;
    if (how.by.empty()) how.by = "ada";
    return answer(deliver(MessageType::command, how, source));
  }
  std::string let_go(std::uint64_t number = 1, const std::string& source = "cloud") {
    Velocity how;
    how.drive = number;
    how.over = true;
    return drive({}, how, source);
  }
  Velocity another(std::uint64_t number, bool take = false, const std::string& by = "bob") {
    Velocity how;
    how.drive = number;
    how.take = take;
    how.by = by;
    return how;
  }
  std::string sent() { return written(Channel::command); }
  Nack why() { return nack_of(last_id); }
  std::string control() {
    const auto profiles = told<NodeProfile>();
    return profiles.empty() ? "?" : get<NodeProfile>(profiles.back().body).control;
  }

  DrivePart part = DrivePart::base;
  std::uint64_t sequence = 0;
};

}  // namespace

TEST_CASE("speeds go to the robot in its units, as long as they come; then it stands, once") {
  HandFixture fixture;
  CHECK(fixture.drive({0.2, 0.5}) == "ack driving");
  CHECK(fixture.sent() == "SPEED 200 0.5\n");
  fixture.wait(0.1);
  CHECK(fixture.drive({0.3}) == "ack driving");  // what is missing is 0
  CHECK(fixture.sent() == "SPEED 300 0\n");
  fixture.wait(0.24);
  CHECK(fixture.sent().empty());
  fixture.wait(0.02);
  CHECK(fixture.sent() == "SPEED 0 0\n");
  CHECK(fixture.counted("drives.dead_man") == 1);
  fixture.wait(0.25);
  CHECK(fixture.sent() == "SPEED 0 0\n");  // and the drive is over
  fixture.wait(20);
  CHECK(fixture.sent().empty());
}

TEST_CASE("after a gap of 250 ms the robot stands, and the same drive moves it on; after 500 ms it does not") {
  HandFixture fixture;
  fixture.drive({0.2});
  fixture.sent();
  fixture.wait(0.3);
  CHECK(fixture.sent() == "SPEED 0 0\n");
  CHECK(fixture.control() == "cloud");
  CHECK(fixture.drive({0.2}) == "ack driving");
  CHECK(fixture.sent() == "SPEED 200 0\n");
  fixture.wait(0.3);
  CHECK(fixture.sent() == "SPEED 0 0\n");
  fixture.wait(0.25);
  CHECK(fixture.control().empty());
  CHECK(fixture.drive({0.2}) == "nack conflict");
}

TEST_CASE("a robot that was not to move is not told to stand by a gap") {
  HandFixture fixture;
  fixture.drive({0.2});
  fixture.drive({});
  fixture.sent();
  fixture.wait(0.45);
  CHECK(fixture.sent().empty());
  CHECK(fixture.counted("drives.dead_man") == 0);
  CHECK(fixture.drive({0, 0}) == "ack driving");
}

TEST_CASE("a late message of a drive that is over moves nothing, and learns why it was over") {
  HandFixture fixture;
  fixture.drive({0.2});
  fixture.wait(0.5);
  fixture.sent();
  CHECK(fixture.drive({0.2}) == "nack conflict");
  CHECK(fixture.why().what == "drive: this one is over: nothing more was heard for 500 ms");
  CHECK(fixture.sent().empty());
  CHECK(fixture.drive({0.2}, fixture.another(2)) == "ack driving");
  CHECK(fixture.sent() == "SPEED 200 0\n");
}

TEST_CASE("who lets go has the robot stand at once, and leaves control free") {
  HandFixture fixture;
  fixture.drive({0.2});
  CHECK(fixture.control() == "cloud");
  fixture.sent();
  CHECK(fixture.let_go() == "ack over");
  CHECK(fixture.sent() == "SPEED 0 0\n");
  CHECK(fixture.control().empty());
  CHECK(fixture.drive({0.2}) == "nack conflict");
  CHECK(fixture.drive({0.2}, fixture.another(7), "office") == "ack driving");
}

TEST_CASE("who lets go before the first message came has begun nothing") {
  HandFixture fixture;
  CHECK(fixture.let_go(5) == "ack over");
  CHECK(fixture.drive({0.2}, fixture.another(5)) == "nack conflict");
  CHECK(fixture.sent().empty());
  CHECK(fixture.drive({0.2}, fixture.another(5), "office") == "ack driving");  // another node's numbers are its own
}

TEST_CASE("an older message does not overtake a newer one") {
  HandFixture fixture;
  fixture.drive({0.2});
  fixture.drive({0.3});
  fixture.sent();
  Velocity late;
  late.sequence = 1;
  CHECK(fixture.drive({0.1}, late) == "nack conflict");
  CHECK(fixture.why().what == "sequence: 1 is not newer than 2");
  late.sequence = 2;
  CHECK(fixture.drive({0.1}, late) == "nack conflict");
  CHECK(fixture.sent().empty());
  CHECK(fixture.drive({0.1}) == "ack driving");  // the drive goes on
}

TEST_CASE("a refused message keeps no drive alive") {
  HandFixture fixture;
  fixture.drive({0.2});
  fixture.sent();
  fixture.wait(0.2);
  CHECK(fixture.drive({0.1, 0, 0}) == "nack bad_value");
  fixture.wait(0.06);
  CHECK(fixture.sent() == "SPEED 0 0\n");
}

TEST_CASE("speeds beyond the limits are clamped to them; what is no speed is refused by its field") {
  HandFixture fixture;
  CHECK(fixture.drive({9, -9}) == "ack driving");
  CHECK(fixture.sent() == "SPEED 500 -1\n");
  CHECK(fixture.drive({0.1, 0.1, 0.1}) == "nack bad_value");
  CHECK(fixture.why().what == "speeds: 3 of them, and 'base' has 2 axes");
  CHECK(fixture.why().hint == "give at most one for each of: x, yaw");
  CHECK(fixture.drive({0.1, std::numeric_limits<double>::quiet_NaN()}) == "nack bad_value");
  CHECK(fixture.why().what == "speeds[1]: is no finite number");
  CHECK(fixture.drive({std::numeric_limits<double>::infinity()}) == "nack bad_value");
  fixture.part = DrivePart::tool;
  CHECK(fixture.drive({0.1}) == "nack bad_value");
  CHECK(fixture.why().what == "part: the robot has no 'tool' that can be driven");
  CHECK(fixture.why().hint == "use one of: base");
  CHECK(fixture.sent().empty());
}

TEST_CASE("an axis with a factor of its own, and one that has only one direction") {
  Settings settings = driven_cart();
  settings.description.drives[0].axes = {{"x", 0.5, true, {}}, {"yaw", 1, false, -0.5}};
  settings.description.drives[0].command.parameters[1].unit = "";
  HandFixture fixture(settings);
  fixture.drive({-0.2, 1});
  CHECK(fixture.sent() == "SPEED 0 -0.5\n");
}

TEST_CASE("an order to stand of its own") {
  Settings settings = driven_cart();
  settings.description.drives[0].stand = make_skill("home", "");
  HandFixture fixture(settings);
  fixture.drive({0.2});
  fixture.sent();
  fixture.let_go();
  CHECK(fixture.sent() == "HOME\n");
}

TEST_CASE("another person of the same cloud, and another node: who has it keeps it, unless it is taken") {
  HandFixture fixture;
  fixture.drive({0.2});
  fixture.sent();
  CHECK(fixture.drive({0.1}, fixture.another(2)) == "nack control_held");
  CHECK(fixture.why().what == "'ada' at 'cloud' drives cart by hand");
  CHECK(fixture.drive({0.1}, fixture.another(1), "office") == "nack control_held");
  CHECK(fixture.why().what.find("'cloud' has controlled cart") == 0);
  CHECK(fixture.why().hint == "wait until it is free, or take it over: trb drive cart --take (\"take\" in the API)");
  CHECK(fixture.sent().empty());
  CHECK(fixture.drive({0.1}, fixture.another(1, true), "office") == "ack driving");
  CHECK(fixture.sent() == "SPEED 0 0\nSPEED 100 0\n");  // it stood in between
  CHECK(fixture.drive({0.2}) == "nack conflict");
  CHECK(fixture.why().what == "drive: this one is over: 'office' has taken it over");
  CHECK(fixture.drive({0.2}, fixture.another(3)) == "nack control_held");
  CHECK(fixture.let_go(1, "office") == "ack over");
  CHECK(fixture.drive({0.2}, fixture.another(3)) == "ack driving");
}

TEST_CASE("the lease is held as long as the drive lasts, and is free when it is over") {
  HandFixture fixture;
  for (int i = 0; i < 150; ++i) {  // longer than a lease without a command
    CHECK(fixture.drive({0.2}) == "ack driving");
    fixture.wait(0.1);
  }
  CHECK(fixture.control() == "cloud");
  fixture.wait(0.4);
  CHECK(fixture.control().empty());
}

TEST_CASE("a stop ends the drive, and a release does not begin it again") {
  HandFixture fixture;
  fixture.drive({0.2});
  fixture.sent();
  fixture.deliver(MessageType::command, Stop{"a person is in the way"}, "ur3");
  CHECK(fixture.sent() == "HALT\n");
  CHECK(fixture.drive({0.2}, fixture.another(2)) == "nack fenced");
  fixture.deliver(MessageType::command, Release{}, "ur3");
  CHECK(fixture.drive({0.2}) == "nack conflict");
  CHECK(fixture.why().what == "drive: this one is over: stopped by ur3: a person is in the way");
  fixture.wait(1);
  CHECK(fixture.sent().empty());
  CHECK(fixture.drive({0.2}, fixture.another(2)) == "ack driving");
}

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

TEST_CASE("a skill under way, and a part that is out of use") {
  HandFixture fixture;
  fixture.deliver(MessageType::command, order("home", ""), "cart");
  fixture.sent();
  CHECK(fixture.drive({0.1}) == "nack control_held");
  CHECK(fixture.drive({0.1}, fixture.another(2, true)) == "nack busy");
  CHECK(fixture.sent().empty());
  HandFixture other;
  other.drive({0.2});
  other.sent();
  other.deliver(MessageType::command, TakeOutOfUse{{"mobile", Severity::critical, "a wheel is flat", 0, false, ""}},
                "cart");
  CHECK(other.sent() == "SPEED 0 0\n");
  CHECK(other.drive({0.2}, other.another(2)) == "nack out_of_use");
  CHECK(other.why().what == "'mobile' is out of use: a wheel is flat");
}

TEST_CASE("no command disturbs a drive, unless it takes control: then the robot stands first") {
  HandFixture fixture;
  fixture.drive({0.2});
  fixture.sent();
  CHECK(fixture.answer(fixture.send(MessageType::command, "go", "1", "cloud")) == "nack busy");
  CHECK(fixture.answer(fixture.send(MessageType::command, "go", "1", "office")) == "nack control_held");
  CHECK(fixture.sent().empty());
  fixture.flags = kFlagTakeControl;
  CHECK(fixture.answer(fixture.send(MessageType::command, "go", "1", "office")) == "ack handed_over");
  CHECK(fixture.sent() == "SPEED 0 0\nGO 1\n");
}

TEST_CASE("a message whose time is over when it comes moves nothing") {
  HandFixture fixture;
  fixture.remaining_ms = 0;
  CHECK(fixture.drive({0.2}) == "nack expired");
  CHECK(fixture.sent().empty());
  CHECK(fixture.let_go() == "ack over");  // to stand it is never too late
}

TEST_CASE("a process that ends has its robot stand") {
  HandFixture fixture;
  fixture.drive({0.2});
  fixture.sent();
  CHECK_FALSE(fixture.core.idle());
  fixture.core.leave(fixture.now, fixture.out);
  CHECK(fixture.sent() == "SPEED 0 0\n");
}

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

namespace {

Settings driven_ur() {
  Settings settings = ur3();
  Drive drive;
  drive.part = DrivePart::joints;
  for (const char* name : {"base", "elbow"}) {
    drive.axes.push_back({name, 1, false, {}});
    drive.command.parameters.push_back(make_parameter(name, ParameterType::number, "rad/s"));
  }
  drive.command.subtype = "drive";
  drive.command.capability = "reach";
  drive.command.data = "[{base}, {elbow}]";
  Skill stand = make_skill("stand", "");
  drive.stand = std::move(stand);
  settings.description.drives = {std::move(drive)};
  settings.commands.commands["drive"] = "speedj({data}, 1, 0.5)";
  settings.commands.commands["stand"] = "stopj(2)";
  return settings;
}

struct HandUrFixture : UrFixture {
  HandUrFixture() : UrFixture(driven_ur()) {}
  std::string drive(double speed, bool over = false) {
    Velocity how{DrivePart::joints, {speed}, 1, ++sequence, over, false, "ada"};
    return answer(deliver(MessageType::command, how, "cloud"));
  }
  std::uint64_t sequence = 0;
};

}  // namespace

TEST_CASE("speeds that have not left yet are replaced by newer ones") {
  HandUrFixture fixture;
  CHECK(fixture.drive(0.1) == "ack driving");
  CHECK(fixture.sent().find("speedj([0.1, 0], 1, 0.5)") != std::string::npos);
  CHECK(fixture.drive(0.2) == "ack driving");
  CHECK(fixture.drive(0.3) == "ack driving");
  CHECK(fixture.sent().empty());  // the controller has not begun the first one
  fixture.monitor(ur_started("trb_77_1"));
  const std::string next = fixture.sent();
  CHECK(next.find("speedj([0.3, 0], 1, 0.5)") != std::string::npos);
  CHECK(next.find("0.2") == std::string::npos);
  fixture.monitor(ur_stopped("trb_77_1") + ur_started("trb_77_2"));
  CHECK(fixture.sent().empty());
  CHECK(fixture.counted("from_robot.failed") == 0);  // a program that is replaced has not failed
}

TEST_CASE("an order to stand does not wait for speeds that have not left, and nothing leaves after it") {
  HandUrFixture fixture;
  fixture.drive(0.1);
  fixture.drive(0.2);
  fixture.sent();
  CHECK(fixture.drive(0, true) == "ack over");
  CHECK(fixture.sent().find("stopj(2)") != std::string::npos);
  fixture.monitor(ur_started("trb_77_1") + ur_started("trb_77_2"));
  CHECK(fixture.sent().empty());
}

TEST_CASE("a robot that takes no speeds for 500 ms is told to stand, though they still come") {
  HandUrFixture fixture;
  for (int i = 0; i < 5; ++i) {
    CHECK(fixture.drive(0.1) == "ack driving");
    fixture.live(0.1);
  }
  CHECK(fixture.drive(0.1) == "nack conflict");
  CHECK(fixture.nack_of(fixture.last_id).what ==
        "drive: this one is over: the robot has not taken its speeds for 500 ms");
  CHECK(fixture.sent().find("stopj(2)") != std::string::npos);
}

TEST_CASE("what the robot refuses ends the drive; if it does not take the order to stand, it is halted") {
  HandUrFixture fixture;
  fixture.drive(0.1);
  fixture.sent();
  fixture.monitor(ur_exception(2, 3, "compile_error_name_not_found:speedj:"));
  const std::string told = fixture.sent();
  CHECK(told.find("stopj(2)") != std::string::npos);
  CHECK(fixture.drive(0.1) == "nack conflict");
  fixture.monitor(ur_exception(2, 3, "compile_error_name_not_found:stopj:"));
  CHECK(fixture.sent() == "stop program\n");
}

TEST_CASE("an arm that is off is not driven, and says what to do") {
  HandUrFixture fixture;
  fixture.state({.mode = 3});
  CHECK(fixture.drive(0.1) == "nack robot_error");
  CHECK(fixture.nack_of(fixture.last_id).what == "the arm is powered off");
  fixture.state();
  CHECK(fixture.drive(0.1) == "ack driving");  // it had not begun
}

TEST_CASE("the fleet is told what can be driven") {
  HandFixture fixture;
  fixture.out.clear();
  fixture.welcome();
  const auto profile = fixture.one<NodeProfile>();
  REQUIRE(profile.drives.size() == 1);
  CHECK(profile.drives[0] == DriveInfo{DrivePart::base, {"x", "yaw"}, {0.5, 1}});
}
