// Stop, release and the fence between them.
#include "services/mode-adapter/test/bench.hpp"

using namespace trb;
using namespace trb::adapter;

namespace {

class StopBench : public Bench {
 public:
  explicit StopBench(Settings settings = pioneer()) : Bench(std::move(settings)) { up(Channel::field); }
  std::uint64_t stop(const std::string& source = "operator") {
    return deliver(MessageType::command, Stop{"a person is in the way"}, source);
  }
  std::uint64_t release() { return deliver(MessageType::command, Release{"all clear"}); }
};

}  // namespace

TEST_CASE("a stop overtakes the queue and the rest of a message, and is answered once the robot has confirmed it") {
  StopBench bench;
  const auto first = bench.command("move", "1");
  const auto second = bench.command("move", "2");
  bench.take_fields(2);
  bench.written();
  const auto stop = bench.stop();
  CHECK(bench.written() == "!stop\n");
  CHECK(bench.answer(first) == "nack fenced");
  CHECK(bench.answer(second) == "nack fenced");
  bench.wait(0);
  CHECK(bench.fence_writes == std::vector<bool>{true});
  CHECK(bench.answer(stop).empty());
  bench.say("ok\n!stopped\n");  // an ok under way counts for nothing
  CHECK(bench.answer(stop) == "ack stopped");
  CHECK(bench.written().empty());
  CHECK(bench.counted("to_robot.stop") == 1);
}

TEST_CASE("the robot is told before the disk, the answer comes after it") {
  StopBench bench;
  const auto stop = bench.stop();
  CHECK(bench.written() == "!stop\n");
  CHECK(bench.fence_writes.empty());
  bench.say("!stopped\n");
  CHECK(bench.answer(stop).empty());
  bench.wait(0);
  CHECK(bench.answer(stop) == "ack stopped");
}

TEST_CASE(
    "a fence that cannot be written is no promise: the robot stops, the answer says so, the disk is tried again") {
  StopBench bench;
  bench.fence_status = fail(Errc::io_error, "state/fence: no space left on device");
  const auto stop = bench.stop();
  CHECK(bench.written() == "!stop\n");
  bench.wait(0);
  CHECK(bench.answer(stop) == "nack io_error");
  CHECK(bench.answer(bench.command("move", "1")) == "nack fenced");
  bench.fence_status = Done{};
  bench.wait(1);
  CHECK(bench.fence_writes.size() == 2);
  bench.say("!stopped\n");
  const auto again = bench.stop();
  bench.wait(0);
  bench.say("!stopped\n");
  CHECK(bench.answer(again) == "ack stopped");
}

TEST_CASE("while fenced commands are refused, requests and information still go; release lifts it") {
  StopBench bench;
  bench.stop();
  bench.wait(0);
  bench.say("!stopped\n");
  const auto refused = bench.command("move", "1");
  CHECK(bench.answer(refused) == "nack fenced");
  CHECK(bench.nack_of(refused).cure == "trb release pioneer");
  bench.written();
  bench.send(MessageType::request, "position", "");
  CHECK(bench.take_fields() == "request\nposition\noperator\n0\n\n");
  bench.send(MessageType::information, "heat", "");
  CHECK(bench.take_fields() == "information\nheat\noperator\n0\n\n");
  const auto release = bench.release();
  CHECK(bench.written() == "!release\n");
  CHECK(bench.fence_writes == std::vector<bool>{true, false});
  CHECK(bench.answer(release).empty());
  bench.say("!released\n");
  CHECK(bench.answer(release) == "ack released");
  bench.command("move", "1");
  CHECK(bench.take_fields() == "command\nmove\noperator\n1\n1\n");
}

TEST_CASE("a stop received twice is answered twice") {
  StopBench bench;
  const auto first = bench.stop();
  const auto second = bench.stop("ur3");
  CHECK(bench.written() == "!stop\n!stop\n");
  bench.wait(0);
  bench.say("!stopped\n");
  CHECK(bench.answer(first) == "ack stopped");
  CHECK(bench.answer(second).empty());
  bench.say("!stopped\n");
  CHECK(bench.answer(second) == "ack stopped");
  CHECK(bench.fence_writes.size() == 1);
}

TEST_CASE("a robot that does not confirm: the fence holds, and the answer says what is not known") {
  StopBench bench;
  const auto stop = bench.stop();
  bench.wait(2);
  CHECK(bench.answer(stop) == "nack timeout");
  CHECK(bench.nack_of(stop).what.find("fenced") != std::string::npos);
  CHECK(bench.answer(bench.command("move", "1")) == "nack fenced");
}

TEST_CASE("a robot that is not connected is told to stop when it comes, and to go on if it was released meanwhile") {
  Bench bench(pioneer());
  const auto stop = bench.deliver(MessageType::command, Stop{"why not"});
  bench.wait(0);
  CHECK(bench.answer(stop) == "nack robot_offline");
  CHECK(bench.nack_of(stop).what.find("fenced") != std::string::npos);
  bench.up(Channel::field);
  CHECK(bench.written() == "!stop\n");
  bench.say("!stopped\n");
  bench.down(Channel::field);
  const auto release = bench.deliver(MessageType::command, Release{""});
  CHECK(bench.answer(release) == "ack released");
  bench.up(Channel::field);
  CHECK(bench.written() == "!release\n");
  bench.say("!released\n");
  bench.down(Channel::field);
  bench.up(Channel::field);
  CHECK(bench.written().empty());
}

TEST_CASE("a node that was fenced when it ended boots fenced, and says so") {
  Settings settings = pioneer();
  settings.fenced = true;
  Bench bench(settings);
  bench.welcome();
  CHECK(bench.one<AdapterState>().fenced);
  CHECK(bench.one<NodeProfile>().fenced);
  bench.up(Channel::field);
  CHECK(bench.written() == "!stop\n");
  CHECK(bench.answer(bench.command("move", "1")) == "nack fenced");
}

TEST_CASE("a release that comes before the robot's confirmation ends the waiting for it") {
  StopBench bench;
  const auto stop = bench.stop();
  bench.wait(0);
  const auto release = bench.release();
  CHECK(bench.answer(stop) == "nack conflict");
  bench.say("!stopped\n!released\n");
  CHECK(bench.answer(release) == "ack released");
}

TEST_CASE("a release that cannot be written leaves the fence where it is") {
  StopBench bench;
  bench.stop();
  bench.wait(0);
  bench.fence_status = fail(Errc::io_error, "state/fence: read-only file system");
  CHECK(bench.answer(bench.release()) == "nack io_error");
  CHECK(bench.answer(bench.command("move", "1")) == "nack fenced");
}

TEST_CASE("a running skill is interrupted by a stop, and says by whom") {
  StopBench bench;
  bench.deliver(MessageType::command, order("home", ""), "pioneer");
  bench.take_fields();
  bench.stop("ur3");
  const auto outcome = bench.one<Outcome>();
  CHECK(outcome.outcome == TaskOutcome::interrupted);
  CHECK(outcome.reason == "stopped by ur3: a person is in the way");
  bench.say("!stopped\ninformation\ndone\n\n4\nhome\n");
  CHECK(bench.told<Outcome>().empty());
  CHECK(bench.counted("refused.late_done") == 1);
  CHECK(bench.answer(bench.deliver(MessageType::command, order("home", "", 2), "pioneer")) == "nack fenced");
}

TEST_CASE("a storm of stops is bounded, in lines and in answers") {
  StopBench bench;
  for (int i = 0; i < 1000; ++i) bench.stop();
  CHECK(bench.written().size() == 64 * std::string("!stop\n").size());
  CHECK(bench.told<Nack>().size() == 1000 - 64);
}

TEST_CASE("stop on an arm: the vendor's words, confirmed by a state that is younger than the stop") {
  UrBench bench;
  bench.command("move", "[0,0,0,0,0,0]");
  bench.monitor(ur_started("trb_1"));
  bench.sent();
  bench.live(0.3, {.running = true});
  const auto stop = bench.deliver(MessageType::command, Stop{""});
  CHECK(bench.sent() == "stop program\n");
  bench.wait(0.05);
  bench.state();  // may have been made before the stop arrived
  CHECK(bench.answer(stop).empty());
  bench.wait(0.06);
  bench.state({.running = true});
  CHECK(bench.answer(stop).empty());
  bench.wait(0.1);
  bench.state();
  CHECK(bench.answer(stop) == "ack stopped");
}

TEST_CASE("stop on an arm that is known to be idle is confirmed at once, a silent one is not") {
  UrBench bench;
  bench.live(0.5);
  const auto stop = bench.deliver(MessageType::command, Stop{""});
  bench.wait(0);
  CHECK(bench.answer(stop) == "ack stopped");
  CHECK(bench.sent() == "stop program\n");
  const auto release = bench.deliver(MessageType::command, Release{""});
  CHECK(bench.answer(release) == "ack released");
  CHECK(bench.sent().empty());

  bench.command("power", "");
  const auto late = bench.deliver(MessageType::command, Stop{""});
  bench.wait(2);
  CHECK(bench.answer(late) == "nack timeout");
}

TEST_CASE("an arm whose controller comes back while the node is fenced is stopped again") {
  UrBench bench;
  bench.live(0.5);
  bench.deliver(MessageType::command, Stop{""});
  bench.sent();
  bench.down(Channel::command);
  bench.up(Channel::command);
  CHECK(bench.sent() == "stop program\n");
}

TEST_CASE("a robot on the field channel of an arm's node is stopped together with the arm") {
  UrBench bench;
  bench.up(Channel::field);
  bench.live(0.5);
  const auto stop = bench.deliver(MessageType::command, Stop{""});
  bench.wait(0);
  CHECK(bench.sent() == "stop program\n");
  CHECK(bench.written() == "!stop\n");
  CHECK(bench.answer(stop).empty());
  bench.say("!stopped\n");
  CHECK(bench.answer(stop) == "ack stopped");
}

TEST_CASE("without a monitor nothing can confirm a stop, and the answer says so") {
  Settings settings = ur3();
  settings.commands.monitor.reset();
  Bench bench(settings);
  bench.up(Channel::command);
  bench.deliver(MessageType::command, Stop{""});
  bench.wait(0);
  CHECK(bench.one<Ack>().text.find("no monitor") != std::string::npos);
}
