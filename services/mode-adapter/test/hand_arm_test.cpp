// An arm that is driven by hand, joint by joint: its controller takes one program at a time, and refuses some.
#include "services/mode-adapter/test/fixture.hpp"

using namespace trb;
using namespace trb::adapter;

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
