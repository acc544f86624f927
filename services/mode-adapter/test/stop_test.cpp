// Stop, release and the fence between them.
#include "services/mode-adapter/test/fixture.hpp"

using namespace trb;
using namespace trb::adapter;

namespace {

class StopFixture : public Fixture {
 public:
  explicit StopFixture(Settings settings = pioneer()) : Fixture(std::move(settings)) { up(Channel::field); }
  std::uint64_t stop(const std::string& source = "operator") {
    return deliver(MessageType::command, Stop{"a person is in the way"}, source);
  }
  std::uint64_t release() { return deliver(MessageType::command, Release{"all clear"}); }
};

}  // namespace

TEST_CASE("a stop overtakes the queue and the rest of a message, and is answered once the robot has confirmed it") {
  StopFixture fixture;
  const auto first = fixture.command("move", "1");
  const auto second = fixture.command("move", "2");
  fixture.take_fields(2);
  fixture.written();
  const auto stop = fixture.stop();
  CHECK(fixture.written() == "!stop\n");
  CHECK(fixture.answer(first) == "nack fenced");
  CHECK(fixture.answer(second) == "nack fenced");
  fixture.wait(0);
  CHECK(fixture.fence_writes == std::vector<bool>{true});
  CHECK(fixture.answer(stop).empty());
  fixture.say("ok\n!stopped\n");  // an ok that was under way does not count
  CHECK(fixture.answer(stop) == "ack stopped");
  CHECK(fixture.written().empty());
  CHECK(fixture.counted("to_robot.stop") == 1);
}

TEST_CASE("the robot is told before the disk, the answer comes after it") {
  StopFixture fixture;
  const auto stop = fixture.stop();
  CHECK(fixture.written() == "!stop\n");
  CHECK(fixture.fence_writes.empty());
  fixture.say("!stopped\n");
  CHECK(fixture.answer(stop).empty());
  fixture.wait(0);
  CHECK(fixture.answer(stop) == "ack stopped");
}

TEST_CASE(
    "a fence that cannot be written is no promise: the robot stops, the answer says so, the disk is tried again") {
  StopFixture fixture;
  fixture.fence_status = fail(Errc::io_error, "state/fence: no space left on device");
  const auto stop = fixture.stop();
  CHECK(fixture.written() == "!stop\n");
  fixture.wait(0);
  CHECK(fixture.answer(stop) == "nack io_error");
  CHECK(fixture.answer(fixture.command("move", "1")) == "nack fenced");
  fixture.fence_status = Done{};
  fixture.wait(1);
  CHECK(fixture.fence_writes.size() == 2);
  fixture.say("!stopped\n");
  const auto again = fixture.stop();
  fixture.wait(0);
  fixture.say("!stopped\n");
  CHECK(fixture.answer(again) == "ack stopped");
}

TEST_CASE("while fenced commands are refused, requests and information still go; release lifts it") {
  StopFixture fixture;
  fixture.stop();
  fixture.wait(0);
  fixture.say("!stopped\n");
  const auto refused = fixture.command("move", "1");
  CHECK(fixture.answer(refused) == "nack fenced");
  CHECK(fixture.nack_of(refused).hint == "trb release pioneer");
  fixture.written();
  fixture.send(MessageType::request, "position", "");
  CHECK(fixture.take_fields() == "request\nposition\noperator\n0\n\n");
  fixture.send(MessageType::information, "heat", "");
  CHECK(fixture.take_fields() == "information\nheat\noperator\n0\n\n");
  const auto release = fixture.release();
  CHECK(fixture.written() == "!release\n");
  CHECK(fixture.fence_writes == std::vector<bool>{true, false});
  CHECK(fixture.answer(release).empty());
  fixture.say("!released\n");
  CHECK(fixture.answer(release) == "ack released");
  fixture.command("move", "1");
  CHECK(fixture.take_fields() == "command\nmove\noperator\n1\n1\n");
}

TEST_CASE("a stop received twice is answered twice") {
  StopFixture fixture;
  const auto first = fixture.stop();
  const auto second = fixture.stop("ur3");
  CHECK(fixture.written() == "!stop\n!stop\n");
  fixture.wait(0);
  fixture.say("!stopped\n");
  CHECK(fixture.answer(first) == "ack stopped");
  CHECK(fixture.answer(second).empty());
  fixture.say("!stopped\n");
  CHECK(fixture.answer(second) == "ack stopped");
  CHECK(fixture.fence_writes.size() == 1);
}

TEST_CASE("a robot that does not confirm: the fence holds, and the answer says what is not known") {
  StopFixture fixture;
  const auto stop = fixture.stop();
  fixture.wait(2);
  CHECK(fixture.answer(stop) == "nack timeout");
  CHECK(fixture.nack_of(stop).what.find("fenced") != std::string::npos);
  CHECK(fixture.answer(fixture.command("move", "1")) == "nack fenced");
}

TEST_CASE("a robot that is not connected is told to stop when it comes, and to go on if it was released meanwhile") {
  Fixture fixture(pioneer());
  const auto stop = fixture.deliver(MessageType::command, Stop{"why not"});
  fixture.wait(0);
  CHECK(fixture.answer(stop) == "nack robot_offline");
  CHECK(fixture.nack_of(stop).what.find("fenced") != std::string::npos);
  fixture.up(Channel::field);
  CHECK(fixture.written() == "!stop\n");
  fixture.say("!stopped\n");
  fixture.down(Channel::field);
  const auto release = fixture.deliver(MessageType::command, Release{""});
  CHECK(fixture.answer(release) == "ack released");
  fixture.up(Channel::field);
  CHECK(fixture.written() == "!release\n");
  fixture.say("!released\n");
  fixture.down(Channel::field);
  fixture.up(Channel::field);
  CHECK(fixture.written().empty());
}

TEST_CASE("a node that was fenced when it ended boots fenced, and says so") {
  Settings settings = pioneer();
  settings.fenced = true;
  Fixture fixture(settings);
  fixture.welcome();
  CHECK(fixture.one<AdapterState>().fenced);
  CHECK(fixture.one<NodeProfile>().fenced);
  fixture.up(Channel::field);
  CHECK(fixture.written() == "!stop\n");
  CHECK(fixture.answer(fixture.command("move", "1")) == "nack fenced");
}

TEST_CASE("a release that comes before the robot's confirmation ends the waiting for it") {
  StopFixture fixture;
  const auto stop = fixture.stop();
  fixture.wait(0);
  const auto release = fixture.release();
  CHECK(fixture.answer(stop) == "nack conflict");
  fixture.say("!stopped\n!released\n");
  CHECK(fixture.answer(release) == "ack released");
}

TEST_CASE("a release that cannot be written leaves the fence where it is") {
  StopFixture fixture;
  fixture.stop();
  fixture.wait(0);
  fixture.fence_status = fail(Errc::io_error, "state/fence: read-only file system");
  CHECK(fixture.answer(fixture.release()) == "nack io_error");
  CHECK(fixture.answer(fixture.command("move", "1")) == "nack fenced");
}

TEST_CASE("a running skill is interrupted by a stop, and says by whom") {
  StopFixture fixture;
  fixture.deliver(MessageType::command, order("home", ""), "pioneer");
  fixture.take_fields();
  fixture.stop("ur3");
  const auto outcome = fixture.one<Outcome>();
  CHECK(outcome.outcome == TaskOutcome::interrupted);
  CHECK(outcome.reason == "stopped by ur3: a person is in the way");
  fixture.say("!stopped\ninformation\ndone\n\n4\nhome\n");
  CHECK(fixture.told<Outcome>().empty());
  CHECK(fixture.counted("refused.late_done") == 1);
  CHECK(fixture.answer(fixture.deliver(MessageType::command, order("home", "", 2), "pioneer")) == "nack fenced");
}

TEST_CASE("a storm of stops is bounded, in lines and in answers") {
  StopFixture fixture;
  for (int i = 0; i < 1000; ++i) fixture.stop();
  CHECK(fixture.written().size() == 64 * std::string("!stop\n").size());
  CHECK(fixture.told<Nack>().size() == 1000 - 64);
}

TEST_CASE("a storm of releases is bounded, and each is answered") {
  StopFixture fixture;
  std::vector<std::uint64_t> releases;
  for (int i = 0; i < 1000; ++i) releases.push_back(fixture.release());
  for (int i = 64; i < 1000; ++i) CHECK(fixture.answer(releases[i]) == "nack not_confirmed");
  CHECK(fixture.answer(releases[63]).empty());
  fixture.wait(2);
  for (int i = 0; i < 64; ++i) CHECK(fixture.answer(releases[i]) == "nack timeout");
}

TEST_CASE("stop on an arm: the vendor's words, confirmed by a state that is younger than the stop") {
  UrFixture fixture;
  fixture.command("move", "[0,0,0,0,0,0]");
  fixture.monitor(ur_started("trb_77_1"));
  fixture.sent();
  fixture.live(0.3, {.running = true});
  const auto stop = fixture.deliver(MessageType::command, Stop{""});
  CHECK(fixture.sent() == "stop program\n");
  fixture.wait(0.05);
  fixture.state();  // may have been made before the stop arrived
  CHECK(fixture.answer(stop).empty());
  fixture.wait(0.06);
  fixture.state({.running = true});
  CHECK(fixture.answer(stop).empty());
  fixture.wait(0.1);
  fixture.state();
  CHECK(fixture.answer(stop) == "ack stopped");
  CHECK(get<Ack>(fixture.told<Ack>().back().body).text.empty());
}

TEST_CASE("a controller that does not understand the stop fails it at once, while the arm moves on") {
  UrFixture fixture;
  fixture.command("move", "[0,0,0,0,0,0]");
  fixture.monitor(ur_started("trb_77_1"));
  fixture.live(0.3, {.running = true});
  const auto stop = fixture.deliver(MessageType::command, Stop{""});
  fixture.wait(0);
  fixture.monitor(ur_exception(1, 1, "syntax_error_on_line:1:stop prgram:"));
  CHECK(fixture.answer(stop) == "nack robot_error");
  CHECK(fixture.nack_of(stop).what.find("refused to stop: line 1, column 1: syntax_error") != std::string::npos);
  CHECK(fixture.nack_of(stop).hint.find("\"stop\" in commands.json") != std::string::npos);
}

TEST_CASE("what the controller says of a program is no refusal of the stop behind it") {
  UrFixture fixture;
  const auto said = [&](const std::string& text) {
    const auto stop = fixture.deliver(MessageType::command, Stop{""});
    fixture.wait(0);
    fixture.monitor(ur_exception(2, 9, text));
    CHECK(fixture.answer(stop).empty());
    fixture.wait(0.2);
    fixture.state();
    CHECK(fixture.answer(stop) == "ack stopped");
  };
  fixture.command("move", "[0,0]");
  SUBCASE("of one that it had not answered yet") {
    said("compile_error_wrong_joint_count:movej:");
  }
  SUBCASE("of one that ran") {
    fixture.monitor(ur_started("trb_77_1"));
    fixture.live(0.3, {.running = true});
    said("runtime_error_robot_not_running:");
  }
}

TEST_CASE("stop on an arm that is known to be idle is confirmed at once, a silent one is not") {
  UrFixture fixture;
  fixture.live(0.5);
  const auto stop = fixture.deliver(MessageType::command, Stop{""});
  fixture.wait(0);
  CHECK(fixture.answer(stop) == "ack stopped");
  CHECK(fixture.one<Ack>().text.find("stood already, so nothing is proved") != std::string::npos);
  CHECK(fixture.sent() == "stop program\n");
  const auto release = fixture.deliver(MessageType::command, Release{""});
  CHECK(fixture.answer(release) == "ack released");
  CHECK(fixture.sent().empty());

  fixture.command("power", "");
  const auto late = fixture.deliver(MessageType::command, Stop{""});
  fixture.wait(2);
  CHECK(fixture.answer(late) == "nack timeout");
}

TEST_CASE("an arm whose controller comes back while the node is fenced is stopped again") {
  UrFixture fixture;
  fixture.live(0.5);
  fixture.deliver(MessageType::command, Stop{""});
  fixture.sent();
  fixture.down(Channel::command);
  fixture.up(Channel::command);
  CHECK(fixture.sent() == "stop program\n");
}

TEST_CASE("a robot on the field channel of an arm's node is stopped together with the arm") {
  UrFixture fixture;
  fixture.up(Channel::field);
  fixture.live(0.5);
  const auto stop = fixture.deliver(MessageType::command, Stop{""});
  fixture.wait(0);
  CHECK(fixture.sent() == "stop program\n");
  CHECK(fixture.written() == "!stop\n");
  CHECK(fixture.answer(stop).empty());
  fixture.say("!stopped\n");
  CHECK(fixture.answer(stop) == "ack stopped");
}

TEST_CASE("without a monitor nothing can confirm a stop, and the answer says so") {
  Settings settings = ur3();
  settings.commands.monitor.reset();
  Fixture fixture(settings);
  fixture.up(Channel::command);
  fixture.deliver(MessageType::command, Stop{""});
  fixture.wait(0);
  CHECK(fixture.one<Ack>().text.find("no monitor") != std::string::npos);
}

TEST_CASE("a release that a stop overtakes says so, and is not answered as if the fence were lifted") {
  StopFixture fixture;
  fixture.stop();
  fixture.wait(0);
  fixture.say("!stopped\n");
  const auto release = fixture.release();
  const auto stop = fixture.stop("ur3");
  CHECK(fixture.answer(release) == "nack conflict");
  CHECK(fixture.nack_of(release).what == "stopped by ur3 before the robot confirmed the release");
  fixture.say("!released\n!stopped\n");
  fixture.wait(0);
  CHECK(fixture.answer(stop) == "ack stopped");
}

TEST_CASE(
    "a release that comes after its deadline leaves the fence: whoever gave it was told that it was not confirmed") {
  StopFixture fixture;
  fixture.stop();
  fixture.say("!stopped\n");
  fixture.written();
  fixture.remaining_ms = 0;
  CHECK(fixture.answer(fixture.release()) == "nack expired");
  CHECK(fixture.written().empty());
  fixture.remaining_ms = 1;
  fixture.release();
  CHECK(fixture.written() == "!release\n");
}
