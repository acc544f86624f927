// The control lease: one commands the robot at a time, and it is taken over by word alone.
#include "services/mode-adapter/core/control_lease.hpp"

#include "services/mode-adapter/test/bench.hpp"

using namespace trb;
using namespace trb::adapter;

namespace {

class ControlBench : public Bench {
 public:
  ControlBench() : Bench(pioneer()) {
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
  /// Who the fleet is told commands the robot, since the last look.
  std::string control() {
    const auto profiles = told<NodeProfile>();
    return profiles.empty() ? "?" : get<NodeProfile>(profiles.back().body).control;
  }
};

}  // namespace

TEST_CASE("who commands first is listened to alone, until 10 s after the last command") {
  ControlBench bench;
  CHECK(bench.move("cloud") == "ack handed_over");
  CHECK(bench.control() == "cloud");
  bench.wait(9);
  CHECK(bench.move("cloud") == "ack handed_over");
  bench.wait(9);
  CHECK(bench.move("ur3") == "nack control_held");
  CHECK(bench.counted("refused.control_held") == 1);
  CHECK(bench.control() == "?");
  bench.wait(1);
  CHECK(bench.control().empty());
  CHECK(bench.move("ur3") == "ack handed_over");
  CHECK(bench.control() == "ur3");
}

TEST_CASE("the refusal names the holder, since when, and the cure") {
  ControlBench bench;
  bench.move("cloud");
  bench.wait(4);
  bench.move("cloud");
  bench.wait(3);
  bench.move("ur3");
  const Nack nack = bench.nack_of(bench.last_id);
  CHECK(nack.what == "'cloud' has controlled pioneer for 7 s; its last command was 3 s ago");
  CHECK(nack.cure == "wait until 10 s after its last command, or take it over: trb send --take");
}

TEST_CASE("the lease is taken over by word, and that is logged and told") {
  ControlBench bench;
  bench.move("cloud");
  bench.out.clear();
  CHECK(bench.move("ur3", kFlagTakeControl) == "ack handed_over");
  CHECK(bench.control() == "ur3");
  REQUIRE(bench.out.logs.size() == 1);
  CHECK(bench.out.logs[0].event == "control_taken_over");
  CHECK(bench.out.logs[0].text == "by 'ur3' from 'cloud'");
  CHECK(bench.counted("control.taken_over") == 1);
  CHECK(bench.move("cloud") == "nack control_held");
}

TEST_CASE("a command that the robot cannot take does not take the lease, unless that was asked for") {
  ControlBench bench;
  bench.down(Channel::field);
  CHECK(bench.move("cloud") == "nack no_field_channel");
  CHECK(bench.control().empty());
  CHECK(bench.move("cloud", kFlagTakeControl) == "nack no_field_channel");
  CHECK(bench.control() == "cloud");
  CHECK(bench.move("ur3") == "nack no_field_channel");  // the cause is told that waiting would not cure
  bench.up(Channel::field);
  CHECK(bench.move("ur3") == "nack control_held");
}

TEST_CASE("stop, release, requests and information are taken from everybody and change no lease") {
  ControlBench bench;
  bench.move("cloud");
  bench.out.clear();
  const auto question = bench.send(MessageType::request, "battery", "", "ur3");
  bench.take_fields();
  CHECK(bench.answer(question).empty());  // it waits for the robot: it was not refused
  bench.send(MessageType::information, "greeting", "hello", "ur3");
  bench.take_fields();
  const auto stop = bench.deliver(MessageType::command, Stop{"a person is in the way"}, "ur3");
  bench.wait(0);
  bench.say("!stopped\n");
  CHECK(bench.answer(stop) == "ack stopped");
  CHECK(bench.move("cloud") == "nack fenced");
  const auto release = bench.deliver(MessageType::command, Release{"all clear"}, "drone");
  bench.say("!released\n");
  CHECK(bench.answer(release) == "ack released");
  CHECK(bench.control() == "cloud");
  CHECK(bench.move("ur3") == "nack control_held");
  CHECK(bench.move("cloud") == "ack handed_over");
}

TEST_CASE("a run holds the lease as long as its skill runs, and 10 s after it") {
  ControlBench bench;
  CHECK(bench.execute() == "running");
  CHECK(bench.control() == "run run-1");
  bench.take_fields();
  bench.wait(9.9);
  CHECK(bench.move("cloud") == "nack control_held");
  CHECK(bench.nack_of(bench.last_id).what == "'run run-1' has controlled pioneer for 9 s; what it began still runs");
  bench.wait(0.1);  // it times out
  bench.say("!stopped\n!released\n");
  bench.wait(9.9);
  CHECK(bench.move("cloud") == "nack control_held");
  bench.wait(0.1);
  CHECK(bench.move("cloud") == "ack handed_over");
}

TEST_CASE("a run waits while another commands the robot; its scheduler is told who") {
  ControlBench bench;
  bench.move("cloud");
  CHECK(bench.execute() == "nack control_held");
  const auto states = bench.told<AdapterState>();
  REQUIRE(!states.empty());
  CHECK(get<AdapterState>(states.back().body).control == "cloud");
  bench.wait(10);
  CHECK(bench.one<AdapterState>().control.empty());
  CHECK(bench.execute() == "running");
  CHECK(bench.one<AdapterState>().control.empty());  // its own lease keeps the scheduler from nothing
}

TEST_CASE("a take-over stops nothing: the skill runs to its end, the next one waits") {
  ControlBench bench;
  bench.execute();
  bench.take_fields();
  CHECK(bench.move("cloud", kFlagTakeControl) == "ack handed_over");
  CHECK(bench.told<Outcome>().empty());
  CHECK(bench.core.idle() == false);
  bench.say("information\ndone\n\n4\nhome\n");
  CHECK(bench.one<Outcome>().outcome == TaskOutcome::finished);
  CHECK(bench.execute("home", 2) == "nack control_held");
  CHECK(bench.execute("home", 1) == "finished");  // what is known is told to whoever may know it
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
  UrBench bench;
  const auto move = bench.command("move", "[0.1,0,0,0,0,0]");
  bench.monitor(ur_started("trb_1"));
  CHECK(bench.answer(move) == "ack started");
  bench.live(30, {.running = true});
  const auto other = bench.send(MessageType::command, "move", "[0.2,0,0,0,0,0]", "drone");
  CHECK(bench.answer(other) == "nack control_held");
  bench.monitor(ur_text("trb_1 done") + ur_stopped("trb_1"));
  bench.live(10);
  CHECK(bench.answer(bench.send(MessageType::command, "move", "[0.2,0,0,0,0,0]", "drone")).empty());
}
