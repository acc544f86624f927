// The direct mode against a UR controller: the vendor's text, and what the monitor reports about it.
#include "services/mode-adapter/test/fixture.hpp"

using namespace trb;
using namespace trb::adapter;

namespace {

Settings unwrapped() {
  Settings settings = ur3();
  settings.commands.wrap.clear();
  return settings;
}

}  // namespace

TEST_CASE("a command becomes a program with a name, and is answered when the robot says that it has started") {
  UrFixture fixture;
  const auto id = fixture.command("move", kUpright);
  CHECK(fixture.sent() ==
        "def trb_77_1():\n  movej([0, -1.5708, 0, -1.5708, 0, 0])\n  textmsg(\"trb_77_1 done\")\nend\n");
  CHECK(fixture.answer(id).empty());
  fixture.monitor(ur_started("trb_77_1"));
  CHECK(fixture.answer(id) == "ack started");
  fixture.monitor(ur_text("trb_77_1 done") + ur_stopped("trb_77_1"));
  CHECK(fixture.counted("to_robot.move") == 1);
  CHECK(fixture.counted("from_robot.done") == 1);
}

TEST_CASE("the next program is sent once the robot has taken or refused the last, so that a refusal has one owner") {
  UrFixture fixture;
  const auto wrong = fixture.command("move", "[1, 2]");
  const auto right = fixture.command("move", kUpright);
  CHECK(fixture.sent().find("trb_77_2") == std::string::npos);
  fixture.monitor(ur_exception(2, 9, "compile_error_wrong_number_of_joints:2:"));
  CHECK(fixture.nack_of(wrong).code == "robot_error");
  CHECK(fixture.nack_of(wrong).what == "line 2, column 9: compile_error_wrong_number_of_joints:2:");
  CHECK(fixture.sent().starts_with("def trb_77_2():"));
  fixture.monitor(ur_started("trb_77_2"));
  CHECK(fixture.answer(right) == "ack started");
}

TEST_CASE("without a wrap the words leave as a line and count as handed over") {
  UrFixture fixture(unwrapped());
  const auto id = fixture.command("move", kUpright);
  CHECK(fixture.sent() == "movej([0, -1.5708, 0, -1.5708, 0, 0])\n");
  CHECK(fixture.answer(id) == "ack handed_over");
}

TEST_CASE("words of the controller's interface are never wrapped: they are no script") {
  UrFixture fixture;
  const auto id = fixture.command("power", "");
  CHECK(fixture.sent() == "power on\n");
  CHECK(fixture.answer(id) == "ack handed_over");
}

TEST_CASE("no text becomes a statement: a quote in it is refused before anything is written") {
  UrFixture fixture;
  CHECK(fixture.answer(fixture.command("say", R"("x\") stopj(2) (\"")")) == "nack not_escapable");
  CHECK(fixture.answer(fixture.command("say", R"("two\nlines")")) == "nack not_escapable");
  CHECK(fixture.answer(fixture.command("say", "\"grün\"")) == "nack not_escapable");
  CHECK(fixture.answer(fixture.command("move", "[0,0,0,0,0,0]); power off(")) == "nack bad_value");
  CHECK(fixture.nack_of(fixture.command("move", "home")).hint.find("list of numbers") != std::string::npos);
  CHECK(fixture.sent().empty());
  fixture.command("say", "\"hello; world\"");
  CHECK(fixture.sent().find("textmsg(\"hello; world\")") != std::string::npos);
}

TEST_CASE("what the controller still reports of an earlier process's program is not taken for this one's") {
  Settings settings = ur3();
  settings.instance = 5'000'041;
  UrFixture fixture(settings);
  fixture.deliver(MessageType::command,
                  Execute{attempt(), 1, settings.instance, "reach", R"({"joints": [0,0,0,0,0,0]})", 0}, "ur3");
  CHECK(fixture.sent().starts_with("def trb_41_1():"));
  fixture.monitor(ur_started("trb_41_1"));
  fixture.monitor(ur_text("trb_77_1 done") + ur_stopped("trb_77_1"));
  CHECK(fixture.told<Outcome>().empty());
  fixture.monitor(ur_text("trb_41_1 done") + ur_stopped("trb_41_1"));
  CHECK(fixture.one<Outcome>().outcome == TaskOutcome::finished);
}

TEST_CASE("a robot that neither starts nor refuses a program does not hold up the next one for ever") {
  UrFixture fixture;
  fixture.remaining_ms = 1000;
  const auto silent = fixture.command("move", kUpright);
  fixture.remaining_ms = 5000;
  fixture.command("move", kUpright);
  fixture.sent();
  fixture.live(1);
  CHECK(fixture.answer(silent) == "nack timeout");
  CHECK(fixture.sent().starts_with("def trb_77_2():"));
}

TEST_CASE("the queue of programs is bounded") {
  UrFixture fixture;
  for (int i = 0; i < 65; ++i) CHECK(fixture.answer(fixture.command("move", kUpright)).empty());
  CHECK(fixture.answer(fixture.command("move", kUpright)) == "nack queue_full");
}

TEST_CASE("a request is answered with what the monitor last told") {
  UrFixture fixture;
  CHECK(fixture.answer(fixture.send(MessageType::request, "position", "")) ==
        "[0.5000,0.5000,0.5000,0.5000,0.5000,0.5000]");
  CHECK(fixture.answer(fixture.send(MessageType::request, "mode", "")) == "7");
  fixture.wait(2.1);
  CHECK(fixture.answer(fixture.send(MessageType::request, "position", "")) == "nack timeout");
}

TEST_CASE("what commands.json has no words for goes to the field channel; with nobody there the answer names both") {
  UrFixture fixture;
  const auto id = fixture.command("dance", "1");
  CHECK(fixture.nack_of(id).code == "no_field_channel");
  CHECK(fixture.nack_of(id).what.find("'dance'") != std::string::npos);
  CHECK(fixture.nack_of(id).what.find("commands.json") != std::string::npos);
  CHECK(fixture.nack_of(id).hint.starts_with("add 'dance' to \"commands\" of commands.json, or use one of"));
  const auto request = fixture.send(MessageType::request, "weather", "");
  CHECK(fixture.nack_of(request).hint.starts_with("add 'weather' to \"requests\" of commands.json"));
  fixture.up(Channel::field);
  fixture.command("dance", "1");
  CHECK(fixture.take_fields() == "command\ndance\noperator\n1\n1\n");
  fixture.send(MessageType::information, "position", "1");
  CHECK(fixture.take_fields() == "information\nposition\noperator\n1\n1\n");
}

TEST_CASE("with the controller gone commands and requests are refused") {
  Fixture fixture(ur3());
  CHECK(fixture.answer(fixture.command("move", kUpright)) == "nack robot_offline");
  CHECK(fixture.answer(fixture.send(MessageType::request, "position", "")) == "nack robot_offline");
}

TEST_CASE("a command under way when the controller is lost is answered") {
  UrFixture fixture;
  const auto id = fixture.command("move", kUpright);
  fixture.down(Channel::command, "connection reset by peer");
  CHECK(fixture.answer(id) == "nack robot_offline");
}

TEST_CASE("a monitor that tells no state for 3 s is hung: it is dialled again, and the robot counts as lost") {
  UrFixture fixture;
  fixture.welcome();
  fixture.told<AdapterState>();
  fixture.wait(2.9);
  CHECK(fixture.closed().empty());
  fixture.wait(0.1);
  CHECK(fixture.closed() == "no state for 3 s;");
  CHECK(fixture.one<AdapterState>().robot == "CONNECTION_BROKEN");
  CHECK(fixture.one<RobotConnection>().detail == "no state for 3 s");
  fixture.up(Channel::monitor);
  CHECK(fixture.told<AdapterState>().empty());  // connected, but still silent
  fixture.state();
  CHECK(fixture.one<AdapterState>().robot == "ONLINE");
}

TEST_CASE("a broken packet closes the monitor") {
  UrFixture fixture;
  fixture.monitor(big_endian(70'000, 4) + "\x14");
  CHECK(fixture.closed().starts_with("bad packet"));
  CHECK(fixture.counted("refused.bad_packet") == 1);
}

TEST_CASE("a protective stop is a fault of everything that the arm can do") {
  UrFixture fixture;
  fixture.state({.protective = true});
  fixture.state({.protective = true});
  auto faults = fixture.told<RobotFault>();
  REQUIRE(faults.size() == 2);
  CHECK(faults[0].target == "*");
  CHECK(get<RobotFault>(faults[0].body).capability == "grab");
  CHECK(get<RobotFault>(faults[1].body).severity == Severity::critical);
  fixture.state({.emergency = true});
  CHECK(fixture.told<RobotFault>().size() == 2);
}

TEST_CASE("an operator's program does not take the arm away from a skill") {
  UrFixture fixture;
  fixture.deliver(MessageType::command, order("reach", R"({"joints": [0,0,0,0,0,0]})"), "ur3");
  CHECK(fixture.answer(fixture.command("move", kUpright)) == "nack control_held");
  fixture.flags = kFlagTakeControl;
  CHECK(fixture.answer(fixture.command("move", kUpright)) == "nack busy");
  fixture.monitor(ur_started("trb_77_1"));
  CHECK(fixture.answer(fixture.command("move", kUpright)) == "nack busy");
  fixture.monitor(ur_text("trb_77_1 done") + ur_stopped("trb_77_1"));
  CHECK(fixture.one<Outcome>().outcome == TaskOutcome::finished);
  CHECK(fixture.answer(fixture.command("move", kUpright)).empty());
}

TEST_CASE("the state of before ends no skill whose command is no program: nothing shows when the robot has it") {
  Settings settings = unwrapped();
  settings.commands.commands["move"] = "load {data}\nplay";
  settings.description.skills[0].end.kind = EndKind::state;
  settings.description.skills[0].end.state = "program_running";
  UrFixture fixture(settings);
  fixture.deliver(MessageType::command, order("reach", R"({"joints": [0,0,0,0,0,0]})"), "ur3");
  fixture.live(0.5, {.running = false});  // it has not loaded the program yet
  CHECK(fixture.told<Outcome>().empty());
  fixture.live(1, {.running = true});
  CHECK(fixture.told<Outcome>().empty());
  fixture.live(0.1, {.running = false});
  CHECK(fixture.one<Outcome>().outcome == TaskOutcome::finished);
}
