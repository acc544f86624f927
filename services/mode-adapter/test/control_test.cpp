// The control lease: one party commands the robot at a time; only an explicit takeover changes that.
#include "services/mode-adapter/core/control_lease.hpp"

#include "services/mode-adapter/test/fixture.hpp"

using namespace trb;
using namespace trb::adapter;

namespace {

class ControlFixture : public Fixture {
 public:
  ControlFixture() : Fixture(pioneer()) {
    up(Channel::field);
    welcome();
    out.clear();
  }
  std::string move(const std::string& source, std::uint16_t how = 0) {
    flags = how;
    const auto id = send(MessageType::command, "move", "1", source);
    flags = 0;
    take_fields();
    return answer(id);
  }
  std::string execute(const std::string& skill = "home", std::uint32_t number = 1) {
    return answer(deliver(MessageType::command, order(skill, "", number), "pioneer"));
  }
  /// The holder that the fleet was notified of since the last call.
  std::string control() {
    const auto profiles = told<NodeProfile>();
    return profiles.empty() ? "?" : get<NodeProfile>(profiles.back().body).control;
  }
};

}  // namespace

TEST_CASE("who commands first is listened to alone, until 10 s after the last command") {
  ControlFixture fixture;
  CHECK(fixture.move("cloud") == "ack handed_over");
  CHECK(fixture.control() == "cloud");
  fixture.wait(9);
  CHECK(fixture.move("cloud") == "ack handed_over");
  fixture.wait(9);
  CHECK(fixture.move("ur3") == "nack control_held");
  CHECK(fixture.counted("refused.control_held") == 1);
  CHECK(fixture.control() == "?");
  fixture.wait(1);
  CHECK(fixture.control().empty());
  CHECK(fixture.move("ur3") == "ack handed_over");
  CHECK(fixture.control() == "ur3");
}

TEST_CASE("the refusal names the holder, since when, and the cure") {
  ControlFixture fixture;
  fixture.move("cloud");
  fixture.wait(4);
  fixture.move("cloud");
  fixture.wait(3);
  fixture.move("ur3");
  const Nack nack = fixture.nack_of(fixture.last_id);
  CHECK(nack.what == "'cloud' has controlled pioneer for 7 s; its last command was 3 s ago");
  CHECK(nack.hint == "wait until 10 s after its last command, or take it over: trb send --take");
}

TEST_CASE("the lease is taken over by word, and that is logged and told") {
  ControlFixture fixture;
  fixture.move("cloud");
  fixture.out.clear();
  CHECK(fixture.move("ur3", kFlagTakeControl) == "ack handed_over");
  CHECK(fixture.control() == "ur3");
  REQUIRE(fixture.out.logs.size() == 1);
  CHECK(fixture.out.logs[0].event == "control_taken_over");
  CHECK(fixture.out.logs[0].text == "by 'ur3' from 'cloud'");
  CHECK(fixture.counted("control.taken_over") == 1);
  CHECK(fixture.move("cloud") == "nack control_held");
}

TEST_CASE("a command that the robot cannot take does not take the lease, unless that was asked for") {
  ControlFixture fixture;
  fixture.down(Channel::field);
  CHECK(fixture.move("cloud") == "nack no_field_channel");
  CHECK(fixture.control().empty());
  CHECK(fixture.move("cloud", kFlagTakeControl) == "nack no_field_channel");
  CHECK(fixture.control() == "cloud");
  CHECK(fixture.move("ur3") == "nack no_field_channel");  // the cause, since waiting would not help
  fixture.up(Channel::field);
  CHECK(fixture.move("ur3") == "nack control_held");
}

TEST_CASE("stop, release, requests and information are taken from everybody and change no lease") {
  ControlFixture fixture;
  fixture.move("cloud");
  fixture.out.clear();
  const auto question = fixture.send(MessageType::request, "battery", "", "ur3");
  fixture.take_fields();
  CHECK(fixture.answer(question).empty());  // it waits for the robot: it was not refused
  fixture.send(MessageType::information, "greeting", "hello", "ur3");
  fixture.take_fields();
  const auto stop = fixture.deliver(MessageType::command, Stop{"a person is in the way"}, "ur3");
  fixture.wait(0);
  fixture.say("!stopped\n");
  CHECK(fixture.answer(stop) == "ack stopped");
  CHECK(fixture.move("cloud") == "nack fenced");
  const auto release = fixture.deliver(MessageType::command, Release{"all clear"}, "drone");
  fixture.say("!released\n");
  CHECK(fixture.answer(release) == "ack released");
  CHECK(fixture.control() == "cloud");
  CHECK(fixture.move("ur3") == "nack control_held");
  CHECK(fixture.move("cloud") == "ack handed_over");
}

TEST_CASE("a run holds the lease as long as its skill runs, and 10 s after it") {
  ControlFixture fixture;
  CHECK(fixture.execute() == "running");
  CHECK(fixture.control() == "run run-1");
  fixture.take_fields();
  fixture.wait(9.9);
  CHECK(fixture.move("cloud") == "nack control_held");
  CHECK(fixture.nack_of(fixture.last_id).what ==
        "'run run-1' has controlled pioneer for 9 s; what it began still runs");
  fixture.wait(0.1);  // its time is over
  fixture.say("!stopped\n!released\n");
  fixture.wait(9.9);
  CHECK(fixture.move("cloud") == "nack control_held");
  fixture.wait(0.1);
  CHECK(fixture.move("cloud") == "ack handed_over");
}

TEST_CASE("a run waits while another commands the robot; its scheduler is told who") {
  ControlFixture fixture;
  fixture.move("cloud");
  CHECK(fixture.execute() == "nack control_held");
  const auto states = fixture.told<AdapterState>();
  REQUIRE(!states.empty());
  CHECK(get<AdapterState>(states.back().body).control == "cloud");
  fixture.wait(10);
  CHECK(fixture.one<AdapterState>().control.empty());
  CHECK(fixture.execute() == "running");
  CHECK(fixture.one<AdapterState>().control.empty());  // the scheduler's own lease does not block it
}

TEST_CASE("a take-over stops nothing: the skill runs to its end, the next one waits") {
  ControlFixture fixture;
  fixture.execute();
  fixture.take_fields();
  CHECK(fixture.move("cloud", kFlagTakeControl) == "ack handed_over");
  CHECK(fixture.told<Outcome>().empty());
  fixture.say("information\ndone\n\n4\nhome\n");
  CHECK(fixture.one<Outcome>().outcome == TaskOutcome::finished);
  CHECK(fixture.execute("home", 2) == "nack control_held");
  CHECK(fixture.execute("home", 1) == "finished");  // an ended attempt's outcome is sent even now
}

TEST_CASE("two runs of one scheduler are one holder") {
  ControlLease lease;
  lease.take({Holder::Kind::run, "a"}, {});
  CHECK(!lease.refusal({Holder::Kind::run, "b"}, "r", {}));
  CHECK(!lease.take({Holder::Kind::run, "b"}, {}));
  CHECK(lease.holder()->text() == "run b");
  CHECK(lease.refusal({Holder::Kind::person, "b"}, "r", {}));
}

TEST_CASE("a program that runs on a controller keeps the lease of who began it") {
  UrFixture fixture;
  const auto move = fixture.command("move", "[0.1,0,0,0,0,0]");
  fixture.monitor(ur_started("trb_77_1"));
  CHECK(fixture.answer(move) == "ack started");
  fixture.live(30, {.running = true});
  const auto other = fixture.send(MessageType::command, "move", "[0.2,0,0,0,0,0]", "drone");
  CHECK(fixture.answer(other) == "nack control_held");
  fixture.monitor(ur_text("trb_77_1 done") + ur_stopped("trb_77_1"));
  fixture.live(10);
  CHECK(fixture.answer(fixture.send(MessageType::command, "move", "[0.2,0,0,0,0,0]", "drone")).empty());
}
