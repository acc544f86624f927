// The direct mode against a UR controller: the vendor's words, and what the monitor tells of them.
#include "services/mode-adapter/test/bench.hpp"

using namespace trb;
using namespace trb::adapter;

namespace {

constexpr const char* kJoints = "[0, -1.5708, 0, -1.5708, 0, 0]";

Settings unwrapped() {
  Settings settings = ur3();
  settings.commands.wrap.clear();
  return settings;
}

}  // namespace

TEST_CASE("a command becomes a program with a name, and is answered when the robot says that it has started") {
  UrBench bench;
  const auto id = bench.command("move", kJoints);
  CHECK(bench.sent() == "def trb_1():\n  movej([0, -1.5708, 0, -1.5708, 0, 0])\n  textmsg(\"trb_1 done\")\nend\n");
  CHECK(bench.answer(id).empty());
  bench.monitor(ur_started("trb_1"));
  CHECK(bench.answer(id) == "ack started");
  bench.monitor(ur_text("trb_1 done") + ur_stopped("trb_1"));
  CHECK(bench.counted("to_robot.move") == 1);
  CHECK(bench.counted("from_robot.done") == 1);
}

TEST_CASE("the next program is sent once the robot has taken or refused the last, so that a refusal has one owner") {
  UrBench bench;
  const auto wrong = bench.command("move", "[1, 2]");
  const auto right = bench.command("move", kJoints);
  CHECK(bench.sent().find("trb_2") == std::string::npos);
  bench.monitor(ur_exception(2, 9, "compile_error_wrong_number_of_joints:2:"));
  CHECK(bench.nack_of(wrong).code == "robot_error");
  CHECK(bench.nack_of(wrong).what == "line 2, column 9: compile_error_wrong_number_of_joints:2:");
  CHECK(bench.sent().starts_with("def trb_2():"));
  bench.monitor(ur_started("trb_2"));
  CHECK(bench.answer(right) == "ack started");
}

TEST_CASE("without a wrap the words leave as a line and count as handed over") {
  UrBench bench(unwrapped());
  const auto id = bench.command("move", kJoints);
  CHECK(bench.sent() == "movej([0, -1.5708, 0, -1.5708, 0, 0])\n");
  CHECK(bench.answer(id) == "ack handed_over");
}

TEST_CASE("words of the controller's interface are never wrapped: they are no script") {
  UrBench bench;
  const auto id = bench.command("power", "");
  CHECK(bench.sent() == "power on\n");
  CHECK(bench.answer(id) == "ack handed_over");
}

TEST_CASE("no text becomes a statement: a quote in it is refused before anything is written") {
  UrBench bench;
  CHECK(bench.answer(bench.command("say", R"("x\") stopj(2) (\"")")) == "nack not_escapable");
  CHECK(bench.answer(bench.command("say", R"("two\nlines")")) == "nack not_escapable");
  CHECK(bench.answer(bench.command("say", "\"grün\"")) == "nack not_escapable");
  CHECK(bench.answer(bench.command("move", "[0,0,0,0,0,0]); power off(")) == "nack bad_value");
  CHECK(bench.nack_of(bench.command("move", "home")).cure.find("list of numbers") != std::string::npos);
  CHECK(bench.sent().empty());
  bench.command("say", "\"hello; world\"");
  CHECK(bench.sent().find("textmsg(\"hello; world\")") != std::string::npos);
}

TEST_CASE("a robot that neither starts nor refuses a program does not hold up the next one for ever") {
  UrBench bench;
  bench.remaining_ms = 1000;
  const auto silent = bench.command("move", kJoints);
  bench.remaining_ms = 5000;
  bench.command("move", kJoints);
  bench.sent();
  bench.live(1);
  CHECK(bench.answer(silent) == "nack timeout");
  CHECK(bench.sent().starts_with("def trb_2():"));
}

TEST_CASE("the queue of programs is bounded") {
  UrBench bench;
  for (int i = 0; i < 65; ++i) CHECK(bench.answer(bench.command("move", kJoints)).empty());
  CHECK(bench.answer(bench.command("move", kJoints)) == "nack queue_full");
}

TEST_CASE("a request is answered with what the monitor last told") {
  UrBench bench;
  CHECK(bench.answer(bench.send(MessageType::request, "position", "")) ==
        "[0.5000,0.5000,0.5000,0.5000,0.5000,0.5000]");
  CHECK(bench.answer(bench.send(MessageType::request, "mode", "")) == "7");
  bench.wait(2.1);
  CHECK(bench.answer(bench.send(MessageType::request, "position", "")) == "nack timeout");
}

TEST_CASE("what commands.json has no words for goes to the field channel; with nobody there the answer names both") {
  UrBench bench;
  const auto id = bench.command("dance", "1");
  CHECK(bench.nack_of(id).code == "no_field_channel");
  CHECK(bench.nack_of(id).what.find("'dance'") != std::string::npos);
  CHECK(bench.nack_of(id).what.find("commands.json") != std::string::npos);
  bench.up(Channel::field);
  bench.command("dance", "1");
  CHECK(bench.take_fields() == "command\ndance\noperator\n1\n1\n");
  bench.send(MessageType::information, "position", "1");
  CHECK(bench.take_fields() == "information\nposition\noperator\n1\n1\n");
}

TEST_CASE("with the controller gone commands and requests are refused") {
  Bench bench(ur3());
  CHECK(bench.answer(bench.command("move", kJoints)) == "nack robot_offline");
  CHECK(bench.answer(bench.send(MessageType::request, "position", "")) == "nack robot_offline");
}

TEST_CASE("a command under way when the controller is lost is answered") {
  UrBench bench;
  const auto id = bench.command("move", kJoints);
  bench.down(Channel::command, "connection reset by peer");
  CHECK(bench.answer(id) == "nack robot_offline");
}

TEST_CASE("a monitor that tells no state for 3 s is hung: it is dialled again, and the robot counts as lost") {
  UrBench bench;
  bench.welcome();
  bench.told<AdapterState>();
  bench.wait(2.9);
  CHECK(bench.closed().empty());
  bench.wait(0.1);
  CHECK(bench.closed() == "no state for 3 s;");
  CHECK(bench.one<AdapterState>().robot == "CONNECTION_BROKEN");
  CHECK(bench.one<RobotConnection>().detail == "no state for 3 s");
  bench.up(Channel::monitor);
  CHECK(bench.told<AdapterState>().empty());  // connected, but still silent
  bench.state();
  CHECK(bench.one<AdapterState>().robot == "ONLINE");
}

TEST_CASE("a broken packet closes the monitor") {
  UrBench bench;
  bench.monitor(big_endian(70'000, 4) + "\x14");
  CHECK(bench.closed().starts_with("bad packet"));
  CHECK(bench.counted("refused.bad_packet") == 1);
}

TEST_CASE("a protective stop is a fault of everything that the arm can do") {
  UrBench bench;
  bench.state({.protective = true});
  bench.state({.protective = true});
  auto faults = bench.told<RobotFault>();
  REQUIRE(faults.size() == 2);
  CHECK(faults[0].target == "*");
  CHECK(get<RobotFault>(faults[0].body).capability == "grab");
  CHECK(get<RobotFault>(faults[1].body).severity == Severity::critical);
  bench.state({.emergency = true});
  CHECK(bench.told<RobotFault>().size() == 2);
}

TEST_CASE("an operator's program does not take the arm away from a skill") {
  UrBench bench;
  bench.deliver(MessageType::command, order("reach", R"({"joints": [0,0,0,0,0,0]})"), "ur3");
  CHECK(bench.answer(bench.command("move", kJoints)) == "nack control_held");
  bench.flags = kFlagTakeControl;
  CHECK(bench.answer(bench.command("move", kJoints)) == "nack busy");
  bench.monitor(ur_started("trb_1"));
  CHECK(bench.answer(bench.command("move", kJoints)) == "nack busy");
  bench.monitor(ur_text("trb_1 done") + ur_stopped("trb_1"));
  CHECK(bench.one<Outcome>().outcome == TaskOutcome::finished);
  CHECK(bench.answer(bench.command("move", kJoints)).empty());
}
