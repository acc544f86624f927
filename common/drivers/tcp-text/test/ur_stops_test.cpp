// What a Universal Robot does when it stops by itself: protective stop, emergency stop, power, runtime exceptions.
#include "services/mode-adapter/test/fixture.hpp"

using namespace trb;
using namespace trb::adapter;

namespace {

Settings with_power() {
  Settings settings = ur3();
  settings.commands.commands.insert(
      {{"power_on", "power on"}, {"run_mode", "set robotmode run"}, {"unlock", "set unlock protective stop"}});
  settings.commands.commands.erase("power");
  return settings;
}

std::string ur_error(int code, int level, const std::string& text) {
  return ur_message(6, big_endian(static_cast<std::uint64_t>(code), 4) + big_endian(0, 4) +
                           big_endian(static_cast<std::uint64_t>(level), 4) + std::string(8, '\0') + text);
}

/// An arm in the middle of a skill's program.
struct Moving : UrFixture {
  Moving() : UrFixture(with_power()) {
    deliver(MessageType::command, order("reach", R"({"joints": [0,0,0,0,0,0]})"), "ur3");
    sent();
    monitor(ur_started("trb_77_1"));
    state({.running = true});
  }
  Outcome end() { return one<Outcome>(); }
};

}  // namespace

TEST_CASE("a protective stop in the middle of a move fails the skill with the reason, in the controller's words") {
  Moving arm;
  arm.monitor(ur_error(153, 3, "position deviates from path") + ur_stopped("trb_77_1"));
  arm.state({.protective = true});
  const Outcome outcome = arm.end();
  CHECK(outcome.outcome == TaskOutcome::failed);
  CHECK(outcome.reason.find("the robot is in protective stop: C153A0 position deviates from path") !=
        std::string::npos);
  const auto faults = arm.told<RobotFault>();
  REQUIRE(faults.size() == 2);
  const auto fault = get<RobotFault>(faults[0].body);
  CHECK(fault.severity == Severity::critical);
  CHECK(fault.text == "protective stop: C153A0 position deviates from path");
  arm.live(1, {.protective = true});
  CHECK(arm.told<RobotFault>().empty());
  CHECK(arm.sent().empty());
}

TEST_CASE(
    "a protective stop keeps the arm out of use until the controller tells that it is over, also to a new process") {
  UrFixture arm;
  arm.state({.protective = true});
  REQUIRE(arm.kept.size() == 1);
  CHECK(arm.answer(arm.deliver(MessageType::command, order("reach", "{}"), "ur3")) == "nack out_of_use");
  arm.state({.emergency = true});  // from bad to worse
  REQUIRE(arm.kept.size() == 1);
  CHECK(arm.kept[0].what.severity == Severity::fatal);
  CHECK(arm.answer(arm.deliver(MessageType::command, TakeIntoUse{"", false, "ann"})) == "nack conflict");
  Settings settings = ur3();
  settings.out_of_use = arm.kept;
  arm.state();
  CHECK(arm.over() == std::vector<std::string>{"grab: emergency stop", "reach: emergency stop"});
  CHECK(arm.kept.empty());
  UrFixture next(settings);  // its first state is a good one
  CHECK(next.over().size() == 2);
}

TEST_CASE("a stop that the controller tells of again on a new connection is told again") {
  UrFixture arm;
  arm.state({.protective = true});
  arm.told<RobotFault>();
  arm.down(Channel::monitor);
  CHECK(arm.answer(arm.deliver(MessageType::command, TakeIntoUse{"", false, "ann"})) == "ack in_use");
  arm.up(Channel::monitor);
  arm.out.clear();
  arm.state({.protective = true});
  CHECK(arm.told<RobotFault>().size() == 2);
  CHECK(arm.kept.size() == 1);
}

TEST_CASE("an emergency stop is fatal; an old complaint is not taken for its cause") {
  Moving arm;
  arm.monitor(ur_error(153, 3, "long ago"));
  arm.live(2.5, {.running = true});
  arm.state({.emergency = true});
  CHECK(arm.end().reason.find("the robot is in emergency stop") != std::string::npos);
  const auto fault = get<RobotFault>(arm.told<RobotFault>().at(0).body);
  CHECK(fault.severity == Severity::fatal);
  CHECK(fault.text == "emergency stop");
}

TEST_CASE("a program that had come to its end when the arm stopped has ended well") {
  Moving arm;
  arm.monitor(ur_text("trb_77_1 done"));
  arm.state({.protective = true});
  CHECK(arm.end().outcome == TaskOutcome::finished);
}

TEST_CASE("while the arm carries nothing out, a command is refused with the way out, and nothing is written") {
  struct Case {
    UrPicture picture;
    std::string what, hint;
  };
  for (const Case& one :
       {Case{{.protective = true}, "protective stop", "trb send ur3 command unlock"},
        Case{{.emergency = true}, "emergency stop", "release the emergency stop at the robot"},
        Case{{.mode = 3}, "powered off", "trb send ur3 command power_on, trb send ur3 command run_mode"},
        Case{{.mode = 5}, "brakes are on", "trb send ur3 command run_mode"},
        Case{{.mode = 2}, "robot mode 2", "pendant"}}) {
    CAPTURE(one.what);
    UrFixture fixture(with_power());
    fixture.state(one.picture);
    const auto id = fixture.command("move", kUpright);
    CHECK(fixture.nack_of(id).code == "robot_error");
    CHECK(fixture.nack_of(id).what.find(one.what) != std::string::npos);
    CHECK(fixture.nack_of(id).hint.find(one.hint) != std::string::npos);
    CHECK(fixture.sent().empty());
    CHECK(fixture.answer(fixture.command("power_on", "")) == "ack handed_over");
    CHECK(fixture.sent() == "power on\n");
    fixture.state();
    CHECK(fixture.answer(fixture.command("move", kUpright)).empty());
  }
}

TEST_CASE("an arm without words for its power is sent to its pendant") {
  UrFixture fixture;
  fixture.state({.mode = 5});
  CHECK(fixture.nack_of(fixture.command("move", kUpright)).hint == "use the robot's pendant");
}

TEST_CASE("a program that was sent and one that waits are refused when the arm stops") {
  UrFixture fixture(with_power());
  const auto sent = fixture.command("move", kUpright);
  const auto waits = fixture.command("move", kUpright);
  fixture.state({.protective = true});
  CHECK(fixture.answer(sent) == "nack robot_error");
  CHECK(fixture.answer(waits) == "nack robot_error");
  fixture.sent();
  fixture.state();
  fixture.live(1);
  CHECK(fixture.sent().empty());  // nothing is repeated
}

TEST_CASE("a runtime exception in a running program ends it with line and column, and is a warning to the fleet") {
  Moving arm;
  arm.monitor(ur_exception(4, 7, "runtime_error_divide_by_zero"));
  CHECK(arm.end().reason.find("line 4, column 7: runtime_error_divide_by_zero") != std::string::npos);
  const auto fault = get<RobotFault>(arm.told<RobotFault>().at(0).body);
  CHECK(fault.severity == Severity::warning);
  CHECK(fault.text == "trb_77_1: line 4, column 7: runtime_error_divide_by_zero");
}

TEST_CASE("a warning of the controller's is a fault of its severity; whatever its text, it stays text") {
  UrFixture fixture(with_power());
  fixture.monitor(ur_error(4, 2, "\"hot\"\njoint\xff"));
  const auto fault = get<RobotFault>(fixture.told<RobotFault>().at(0).body);
  CHECK(fault.severity == Severity::warning);
  CHECK(fault.text == "C4A0 \"hot\"\njoint?");
  for (int i = 0; i < 50; ++i) {  // the controller repeats it in each cycle
    fixture.live(0.1);
    fixture.monitor(ur_error(4, 2, "\"hot\"\njoint\xff"));
  }
  CHECK(fixture.told<RobotFault>().empty());
  fixture.monitor(ur_error(4, 1, "for the curious"));
  CHECK(fixture.told<RobotFault>().empty());
}
