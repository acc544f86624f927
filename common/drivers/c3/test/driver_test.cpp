// The direct mode over C3: what is written into a KUKA's variables, and what is read from them.
#include "common/drivers/c3/krl.hpp"
#include "common/drivers/c3/test/fixture.hpp"
#include "common/drivers/c3/wire.hpp"

using namespace trb;
using namespace trb::adapter;
using namespace std::string_literals;

namespace {

/// A robot with its integrator's own program, which knows nothing of messages.
Settings own_program() {
  Settings settings = kuka();
  settings.description.has_field_channel = false;
  settings.commands.values["trb_done"] = "READY";
  settings.commands.values["trb_result"] = "RESULT";
  settings.commands.commands["move"] = "GOAL = {E6POS: X {0}, Y {1}}\nJOB = 3\nGO = TRUE";
  return settings;
}

}  // namespace

TEST_CASE("a read and a write: the golden bytes") {
  CHECK(c3_request(1, "$OV_PRO", std::nullopt) == "\x00\x01\x00\x0a\x00\x00\x07$OV_PRO"s);
  CHECK(c3_request(0x1234, "$OV_PRO", "50") == "\x12\x34\x00\x0e\x01\x00\x07$OV_PRO\x00\x02\x35\x30"s);
}

TEST_CASE("replies: in pieces, refused, without a value, broken") {
  C3Reader reader;
  std::vector<C3Reply> replies;
  for (const char c : "\x00\x07\x00\x09\x00\x00\x03\x31\x30\x30\x00\x01\x01"s) CHECK(reader.add({&c, 1}, replies));
  REQUIRE(replies.size() == 1);
  CHECK(replies[0].tag == 7);
  CHECK(replies[0].value == "100");
  CHECK(replies[0].ok);
  CHECK(reader.add("\x00\x08\x00\x06\x00\x00\x00\x00\x00\x00\x00\x09\x00\x04\x0c\x00\x07\x00"s, replies));
  REQUIRE(replies.size() == 3);
  CHECK_FALSE(replies[1].ok);
  CHECK(replies[2].error == 7);
  CHECK_FALSE(reader.add("\x00\x07\x00\x09\x00\x00\x04\x31\x30\x30\x00\x01\x01"s, replies));
  CHECK(reader.held() == 0);
}

TEST_CASE("texts: a quote and a newline never end a KRL text") {
  CHECK(krl_field("say \"hi\"\nnow\\") == "\"say \\qhi\\q\\nnow\\\\\"");
  CHECK(krl_text(krl_field("gr\xc3\xbcn \"x\"\r\n\\q")) == "gr\xc3\xbcn \"x\"\r\n\\q");
  CHECK(krl_literal(Value{"plain 'text'"}).value() == "\"plain 'text'\"");
  CHECK(krl_literal(Value{"a\"b"}).error().code == Errc::not_escapable);
  CHECK(krl_literal(Value{"a\nb"}).error().code == Errc::not_escapable);
  CHECK(krl_literal(Value{true}).value() == "TRUE");
  const auto chunks = krl_chunks("12345678\n", 9);
  CHECK(chunks == std::vector<std::string>{"\"12345678\"", "\"\\n\""});
}

TEST_CASE("values: numbers, flags, texts, structures and their components") {
  CHECK(read_krl("-1.5E1", {})->json == "-15");
  CHECK(read_krl("TRUE", {})->numbers == std::vector<double>{1});
  CHECK(read_krl("\"a \\qb\\q\"", {})->json == R"("a \"b\"")");
  CHECK(read_krl("#EX", {})->json == "\"#EX\"");
  CHECK(read_krl("{E6POS: X 1.5, Y 2, S 2}", {})->json == R"({"X":1.5,"Y":2,"S":2})");
  CHECK(read_krl("{E6POS: X 1.5, Y 2, S 2}", {"Y", "X"})->numbers == std::vector<double>{2, 1.5});
  CHECK(read_krl("{E6POS: X 1.5}", {"Z"}).error().code == Errc::missing);
  CHECK(read_krl("{X}", {}).error().code == Errc::malformed);
  CHECK(krl_whole("-2.9") == -2);
  CHECK(krl_whole("1E30") == std::int64_t{1} << 53U);
  CHECK(krl_whole("-1E30") == -(std::int64_t{1} << 53U));
  CHECK(read_krl("{A: X {B: Y 1}}", {}).error().code == Errc::malformed);
}

TEST_CASE("a message goes field by field, and is answered once the robot's program has taken it") {
  C3Fixture fixture;
  CHECK(fixture.writes() == "TRB_COMMAND=FALSE\n");
  const auto id = fixture.command("wave", "hello \"you\"\nand you");
  fixture.serve();
  CHECK(fixture.writes() ==
        "TRB_TYPE[]=\"command\"\nTRB_SUBTYPE[]=\"wave\"\nTRB_SOURCE[]=\"operator\"\nTRB_SIZE=19\n"
        "TRB_DATA[]=\"hello \\qyou\\q\\na\"\nTRB_CHUNK=TRUE\n");
  fixture.live(1);
  CHECK(fixture.answer(id).empty());
  fixture.robot["TRB_CHUNK"] = "FALSE";
  fixture.live(0.1);
  CHECK(fixture.writes() == "TRB_DATA[]=\"nd you\"\nTRB_NUMBER=77000001\nTRB_COMMAND=TRUE\n");
  fixture.take();
  CHECK(fixture.answer(id) == "ack started");
  fixture.finish();
  CHECK(fixture.writes() == "TRB_DONE=FALSE\n");
  CHECK(fixture.counted("from_robot.done") == 1);
}

TEST_CASE("information named as a command of the robot is not given to its program") {
  C3Fixture fixture;
  fixture.writes();
  for (const char* name : {"home", "Home", "move"}) fixture.send(MessageType::information, name, "[1, 2]", "ur3");
  fixture.live(0.5);
  CHECK(fixture.writes().empty());
  CHECK(fixture.counted("refused.not_as_command") == 3);
  fixture.send(MessageType::information, "greeting", "hello", "ur3");
  fixture.live(0.1);
  CHECK(fixture.writes().starts_with("TRB_TYPE[]=\"information\"\nTRB_SUBTYPE[]=\"greeting\"\n"));
}

TEST_CASE("words are written before the message, and must fit the data") {
  C3Fixture fixture;
  fixture.writes();
  fixture.command("move", "[1.5, -2]");
  fixture.serve();
  CHECK(fixture.writes().starts_with(
      "TRB_AXIS={E6AXIS: A1 1.5, A2 -2}\nTRB_TYPE[]=\"command\"\nTRB_SUBTYPE[]=\"move\"\n"));
  CHECK(fixture.answer(fixture.command("move", "[1]")) == "nack bad_value");
  const auto wrong = fixture.command("move", "[1, 2, 3]");
  CHECK(fixture.nack_of(wrong).what == "the command takes 2 items, and the data has 3");
  CHECK(fixture.answer(fixture.command("move", R"(["a\"b", 1])")) == "nack not_escapable");
  CHECK(fixture.answer(fixture.command("move", "home")) == "nack bad_value");
}

TEST_CASE("what the robot's program refuses is told to the sender with its text") {
  C3Fixture fixture;
  const auto id = fixture.command("move", "[400, 0]");
  fixture.live(0.1);
  fixture.number = fixture.robot["TRB_NUMBER"];
  fixture.robot["TRB_COMMAND"] = "FALSE";
  fixture.finish(4, "A1 is out of its range");
  CHECK(fixture.nack_of(id).code == "robot_error");
  CHECK(fixture.nack_of(id).what == "the robot refuses it: A1 is out of its range");
}

TEST_CASE("a variable that is not declared on the robot: the answer names it") {
  C3Fixture fixture;
  fixture.robot.erase("TRB_AXIS");
  const auto id = fixture.command("move", "[1, 2]");
  fixture.serve();
  CHECK(fixture.nack_of(id).what == "the robot refuses TRB_AXIS = {E6AXIS: A1 1, A2 2} (C3 error 0)");
}

TEST_CASE("two commands at once: the second waits for the first's end, or for its own deadline") {
  C3Fixture fixture;
  const auto first = fixture.command("wave", "1");
  fixture.remaining_ms = 1000;
  const auto second = fixture.command("wave", "2");
  fixture.remaining_ms = 8000;
  const auto third = fixture.command("wave", "3");
  fixture.take();
  CHECK(fixture.answer(first) == "ack started");
  fixture.live(1);
  CHECK(fixture.answer(second) == "nack timeout");
  fixture.finish();
  fixture.take();
  CHECK(fixture.robot["TRB_DATA[]"] == "\"3\"");
  CHECK(fixture.answer(third) == "ack started");
}

TEST_CASE("a program that does not take a message: it is withdrawn, and the answer says where to look") {
  C3Fixture fixture;
  const auto id = fixture.command("wave", "1");
  fixture.live(2.1);
  CHECK(fixture.nack_of(id).code == "robot_error");
  CHECK(fixture.nack_of(id).hint.find("trb.src") != std::string::npos);
  CHECK(fixture.robot["TRB_COMMAND"] == "FALSE");
}

TEST_CASE("a skill ends when the program says so, with its text") {
  C3Fixture fixture;
  fixture.deliver(MessageType::request, order("reach", R"({"joints": [1, 2]})"), "kuka");
  fixture.take();
  fixture.flags = kFlagTakeControl;
  CHECK(fixture.answer(fixture.command("wave", "1")) == "nack busy");
  fixture.finish(0, "picked");
  const auto ended = fixture.one<Outcome>();
  CHECK(ended.outcome == TaskOutcome::finished);
  CHECK(ended.data == "\"picked\"");
}

TEST_CASE("the end of an old message is not taken for that of a new one") {
  C3Fixture fixture;
  fixture.begin_home();
  const std::string ours = fixture.number;
  fixture.number = "1999000001";
  fixture.finish();
  CHECK(fixture.counted("refused.late_done") == 1);
  CHECK(fixture.told<Outcome>().empty());
  fixture.number = ours;
  fixture.finish(3, "no part");
  CHECK(fixture.one<Outcome>().reason == "no part");
}

TEST_CASE("a stop overtakes what is under way, and is confirmed by the robot") {
  C3Fixture fixture;
  fixture.command("wave", "first");
  const auto waits = fixture.command("wave", "second");
  fixture.written(Channel::command);
  const auto id = fixture.deliver(MessageType::command, Stop{"test"});
  CHECK(fixture.written(Channel::command).find("TRB_STOP\0\x04TRUE"s) != std::string::npos);
  CHECK(fixture.answer(waits) == "nack fenced");
  C3Fixture calm;
  const auto stop = calm.deliver(MessageType::command, Stop{"test"});
  calm.live(0.5);
  CHECK(calm.answer(stop).empty());
  calm.robot["TRB_STOPPED"] = "TRUE";
  calm.live(0.1);
  CHECK(calm.answer(stop) == "ack stopped");
  CHECK(calm.answer(calm.command("wave", "1")) == "nack fenced");
  const auto release = calm.deliver(MessageType::command, Release{});
  calm.live(0.1);
  CHECK(calm.answer(release).empty());
  calm.robot["TRB_STOPPED"] = "FALSE";
  calm.live(0.1);
  CHECK(calm.answer(release) == "ack released");
  CHECK(fixture.answer(id).empty());
}

TEST_CASE("a stop that the robot does not confirm is told so") {
  C3Fixture fixture;
  const auto id = fixture.deliver(MessageType::command, Stop{"test"});
  fixture.live(2.1);
  CHECK(fixture.answer(id) == "nack timeout");
}

TEST_CASE("a controller that stops its program: a fault with the robot's text, and nothing goes on by itself") {
  C3Fixture fixture;
  fixture.begin_home();
  fixture.robot["TRB_ERROR[]"] = "\"grab URGENT gripper \\qleft\\q lost\"";
  fixture.robot["$STOPMESS"] = "TRUE";
  fixture.live(0.2);
  const auto fault = fixture.one<RobotFault>();
  CHECK(fault.capability == "grab");
  CHECK(fault.severity == Severity::urgent);
  CHECK(fault.text == "gripper \"left\" lost");
  CHECK(fixture.one<Outcome>().outcome == TaskOutcome::failed);
  CHECK(fixture.robot["TRB_STOP"] == "TRUE");
  fixture.flags = kFlagTakeControl;
  CHECK(fixture.nack_of(fixture.command("wave", "1")).hint.find("panel") != std::string::npos);
  fixture.robot["$STOPMESS"] = "FALSE";
  fixture.robot["TRB_STOPPED"] = "TRUE";
  fixture.live(0.3);
  CHECK(fixture.robot["TRB_STOP"] == "FALSE");
}

TEST_CASE("a fault ends when the controller's message is gone, and the text of the program's with the text") {
  C3Fixture fixture;
  fixture.robot["TRB_ERROR[]"] = "\"grab CRITICAL gripper lost\"";
  fixture.robot["$STOPMESS"] = "TRUE";
  fixture.live(1);
  CHECK_FALSE(fixture.kept.empty());
  fixture.robot["TRB_ERROR[]"] = "\"\"";
  fixture.live(1);
  CHECK(fixture.kept.size() == 1);
  CHECK(fixture.over().empty());
  fixture.robot["$STOPMESS"] = "FALSE";
  fixture.live(1);
  CHECK(fixture.kept.empty());
  CHECK(fixture.over() == std::vector<std::string>{"grab: gripper lost"});
}

TEST_CASE("an error text without a stop is a fault, told once") {
  C3Fixture fixture;
  fixture.robot["TRB_ERROR[]"] = "\"air is low\"";
  fixture.live(1);
  const auto faults = fixture.told<RobotFault>();
  REQUIRE(faults.size() == 2);
  CHECK(get<RobotFault>(faults[0].body).text == "air is low");
}

TEST_CASE("a request that commands.json maps is answered with the variable; another by the robot's program") {
  C3Fixture fixture;
  const auto position = fixture.send(MessageType::request, "position", "");
  const auto pose = fixture.send(MessageType::request, "pose", "");
  fixture.serve();
  CHECK(fixture.answer(position) == "[10.5,-20]");
  CHECK(fixture.answer(pose) == R"({"X":10.5,"Y":-20,"Z":3})");
  const auto gripper = fixture.send(MessageType::request, "gripper", "");
  fixture.take();
  fixture.finish(0, "open");
  CHECK(fixture.answer(gripper) == "open");
  const auto unknown = fixture.send(MessageType::request, "weather", "");
  fixture.take();
  fixture.finish(5, "unknown request");
  CHECK(fixture.answer(unknown) == "nack robot_error");
}

TEST_CASE("a member that asks without end keeps the driver neither from its flags nor from a stop's confirmation") {
  C3Fixture fixture;
  // Never idle: the robot answers one of the requests each time, and another is there already.
  const auto live = [&](double time_s) {
    for (auto steps = std::lround(time_s / 0.01); steps > 0; --steps) {
      for (int i = 0; i < 2; ++i) fixture.send(MessageType::request, "position", "", "nosy");
      fixture.wait(0.01);
      for (int i = 0; i < 2; ++i) fixture.serve_one();
    }
  };
  for (int i = 0; i < 8; ++i) fixture.send(MessageType::request, "position", "", "nosy");
  fixture.deliver(MessageType::request, order("home", ""), "kuka");
  live(0.2);
  CHECK(fixture.robot["TRB_COMMAND"] == "TRUE");
  fixture.robot["TRB_COMMAND"] = "FALSE";
  fixture.number = fixture.robot["TRB_NUMBER"];
  live(2.5);
  CHECK(fixture.told<Outcome>().empty());
  fixture.robot["TRB_DONE_NUMBER"] = fixture.number;
  fixture.robot["TRB_DONE"] = "TRUE";
  live(0.3);
  CHECK(fixture.one<Outcome>().outcome == TaskOutcome::finished);
  const auto stop = fixture.deliver(MessageType::command, Stop{"test"});
  fixture.robot["TRB_STOPPED"] = "TRUE";
  live(0.3);
  CHECK(fixture.answer(stop) == "ack stopped");
  CHECK(fixture.counted("from_robot.position") > 100);
}

TEST_CASE("the robot's own messages: chunk by chunk, and never in the middleware's words") {
  C3Fixture fixture;
  const auto say = [&](const std::string& subtype, const std::string& data, int size) {
    fixture.robot["TRB_OUT_TYPE[]"] = "\"information\"";
    fixture.robot["TRB_OUT_SUBTYPE[]"] = '"' + subtype + '"';
    fixture.robot["TRB_OUT_TARGET[]"] = "\"ur3\"";
    fixture.robot["TRB_OUT_SIZE"] = std::to_string(size);
    fixture.robot["TRB_OUT_DATA[]"] = '"' + data + '"';
    fixture.robot["TRB_OUT"] = "TRUE";
    fixture.live(0.3);
    CHECK(fixture.robot["TRB_OUT"] == "FALSE");
  };
  say("greeting", "two\\n", 9);
  CHECK(fixture.told<Opaque>().empty());
  say("greeting", "lines", 9);
  const auto told = fixture.told<Opaque>();
  REQUIRE(told.size() == 1);
  CHECK(told[0].target == "ur3");
  CHECK(get<Opaque>(told[0].body).data == "two\nlines");
  say("stop", "", 0);
  say("greeting", "toolong", 2);
  say("two words", "", 0);
  CHECK(fixture.told<Opaque>().empty());
  CHECK(fixture.counted("refused.typed_subtype") == 1);
  CHECK(fixture.counted("refused.bad_message") == 2);
}

TEST_CASE("a robot that answers nothing for 2 s is dialled again; what was under way ends") {
  C3Fixture fixture;
  const auto id = fixture.command("wave", "1");
  fixture.wait(2.1);
  CHECK(fixture.closed() == "no answer for 2 s;");
  CHECK(fixture.answer(id) == "nack robot_offline");
  C3Fixture moving;
  moving.begin_home();
  moving.wait(2.1);
  CHECK(moving.one<Outcome>().outcome == TaskOutcome::interrupted);
  // It accepts connections, but sends nothing: it counts as gone until it does.
  fixture.up(Channel::command);
  CHECK(fixture.answer(fixture.command("wave", "1")) == "nack robot_offline");
  fixture.serve();
  fixture.remaining_ms = 5000;
  CHECK(fixture.answer(fixture.command("wave", "1")).empty());
}

TEST_CASE("an answer of a tag that nobody has asked with is counted and ignored") {
  C3Fixture fixture;
  fixture.hear(Channel::command, "\x7f\x7f\x00\x09\x00\x00\x03\x31\x30\x30\x00\x01\x01"s);
  CHECK(fixture.counted("refused.unknown_tag") == 1);
  fixture.hear(Channel::command, "\x00\x01\x00\x00"s);
  CHECK(fixture.closed().find("contradict") != std::string::npos);
}

TEST_CASE("an integrator's own program: words, a done flag and a result, no messages") {
  C3Fixture fixture(own_program());
  for (const char* name : {"GOAL", "JOB", "GO", "READY", "RESULT"}) fixture.robot[name] = "0";
  fixture.deliver(MessageType::request, order("reach", R"({"joints": [1, 2]})"), "kuka");
  fixture.live(0.1);
  CHECK(fixture.writes() == "READY=FALSE\nGOAL={E6POS: X 1, Y 2}\nJOB=3\nGO=TRUE\n");
  fixture.robot["READY"] = "TRUE";
  fixture.live(0.2);
  CHECK(fixture.one<Outcome>().outcome == TaskOutcome::finished);
  const auto id = fixture.command("wave", "1");
  CHECK(fixture.answer(id) == "nack no_field_channel");
  const auto stop = fixture.deliver(MessageType::command, Stop{"test"});
  fixture.live(0.1);
  CHECK(fixture.answer(stop) == "ack stopped");
}
