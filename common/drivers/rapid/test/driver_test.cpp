// The interpreter mode for a RAPID server: moves that block, and a service task beside them.
#include "common/drivers/rapid/wire.hpp"
#include "services/mode-adapter/test/bench.hpp"

using namespace trb;
using namespace trb::adapter;

namespace {

Settings abb() {
  Settings settings;
  settings.id = "abb";
  settings.framework = "abb";
  settings.mode = Mode::interpreter;
  settings.instance = kInstance;
  settings.description.capabilities = {"grab", "reach"};
  settings.description.skills = {make_skill("home", "")};
  settings.commands.transport = "rapid";
  settings.commands.port = 5000;
  settings.commands.monitor = Monitor{"rapid-service", 5001};
  settings.commands.commands = {{"move", "2 {0} {1}"}, {"pick", "2 {0} {1}\n20 1"}, {"home", "2 0 0"},
                                {"show", "40 {data}"}, {"stop", "service 91"},      {"release", "service 92"}};
  settings.commands.values = {{"joints", "service 4 0 1"}, {"position", "3 0 1 2"}};
  settings.commands.requests = {{"joints", "joints"}, {"position", "position"}, {"motors", "motors"}};
  return settings;
}

/// Both connections are up, the service task has told its state, and nothing is under way.
class RapidBench : public Bench {
 public:
  explicit RapidBench(Settings settings = abb()) : Bench(std::move(settings)) {
    up(Channel::command);
    up(Channel::monitor);
    live(0.05);
  }
  void program(const std::string& text) { hear(Channel::command, text); }
  void service(const std::string& text) { hear(Channel::monitor, text); }
  /// Time passes; the service task and the values are answered at once, the program's other requests are kept.
  void live(double time_s) {
    for (double t = 0; t < time_s - 1e-9; t += 0.05) {
      serve();
      wait(0.05);
      serve();
    }
  }
  void serve() {
    for (std::string asked = written(Channel::monitor); !asked.empty(); asked = written(Channel::monitor)) {
      for (std::size_t end = asked.find('#'); end != std::string::npos; end = asked.find('#')) {
        const std::string one = asked.substr(0, end + 1);
        asked.erase(0, end + 1);
        if (one == "90 #") service("90 1 " + state + "#");
        if (one == "4 #") service("4 1 1.5 -2#");
        if (one == "91 #" || one == "92 #") turns += one;
        if (one == "91 #" && confirms) service("91 1#");
        if (one == "92 #" && confirms) service("92 1#");
      }
    }
    sent_ += written(Channel::command);
    while (sent_.starts_with("3 #")) {
      sent_.erase(0, 3);
      program("3 1 10.5 20 30#");
      sent_ += written(Channel::command);
    }
  }
  std::string sent() {
    serve();
    return std::exchange(sent_, {});
  }

  std::string state = "0 0 1 0";
  std::string turns;
  bool confirms = true;

 private:
  std::string sent_;
};

}  // namespace

TEST_CASE("answers: in pieces, ended by # or a line end, or by a moment's silence") {
  RapidReader reader;
  MonotonicTime now{1};
  reader.add("2 ", now);
  CHECK_FALSE(reader.next(now));
  reader.add("1#\n4 1 1", now);
  CHECK(*reader.next(now) == "2 1");
  CHECK_FALSE(reader.next(now));
  CHECK(*reader.next(now + seconds(0.1)) == "4 1 1");
  const auto answer = read_rapid_answer("4 1 1.5 -2e1 x%20%22y%22");
  CHECK(answer->numbers == std::vector<double>{1.5, -20});
  CHECK(answer->text == "1.5 -2e1 x \"y\"");
  for (const char* bad : {"", "x", "2", "-1 1", "1.5 1", "99999 1"})
    CHECK_FALSE_MESSAGE(read_rapid_answer(bad).ok(), bad);
}

TEST_CASE("parameters: numbers of six digits, and texts that end nothing") {
  CHECK(rapid_literal(Value{123.4567891}).value() == "123.457");
  CHECK(rapid_literal(Value{true}).value() == "1");
  CHECK(rapid_literal(Value{"say \"hi\"#\n20 1"}).value() == "say%20%22hi%22%23%0A20%201");
  CHECK(rapid_unescaped("say%20%22hi%22%23%0A20%201") == "say \"hi\"#\n20 1");
  CHECK(rapid_unescaped("%").empty());
  CHECK(rapid_unescaped("%25") == "%");
  CHECK(rapid_literal(Value{""}).value() == "%");
  CHECK_FALSE(rapid_literal(Value{Value::Object{}}).ok());
}

TEST_CASE("a move is started once it is not refused at once, and ends with its answer") {
  RapidBench bench;
  const auto id = bench.command("move", "[10, -20.5]");
  CHECK(bench.sent() == "2 10 -20.5 #");
  CHECK(bench.answer(id).empty());
  bench.live(0.4);
  CHECK(bench.answer(id) == "ack started");
  bench.program("2 ");
  bench.program("1#");
  CHECK(bench.counted("from_robot.done") == 1);
}

TEST_CASE("what the robot refuses is told with its text") {
  RapidBench bench;
  const auto id = bench.command("move", "[10, 200]");
  bench.program("2 0 J2%20200%20is%20out%20of%20its%20range#");
  CHECK(bench.nack_of(id).what == "the robot refuses it: J2 200 is out of its range");
  CHECK(bench.nack_of(bench.command("move", "[1]")).what == "the command takes 2 items, and the data has 1");
}

TEST_CASE("a text of more than 80 characters is refused, and one with a quote or a newline ends nothing") {
  RapidBench bench;
  const auto id = bench.command("show", '"' + std::string(76, 'x') + '"');
  CHECK(bench.nack_of(id).code == "too_large");
  CHECK(bench.nack_of(id).what == "the request has 81 characters, and a RAPID string holds 80");
  bench.command("show", R"("a\"\n# 91 #")");
  CHECK(bench.sent() == "40 a%22%0A%23%2091%20%23 #");
}

TEST_CASE("a command of several requests: each waits for the answer of the one before") {
  RapidBench bench;
  bench.command("pick", "[1, 2]");
  CHECK(bench.sent() == "2 1 2 #");
  bench.program("2 1#");
  CHECK(bench.sent() == "20 1 #");
  bench.program("20 1#");
  CHECK(bench.counted("from_robot.done") == 1);
}

TEST_CASE("two commands at once: the second waits for the end of the first, or for its own deadline") {
  RapidBench bench;
  bench.command("move", "[1, 1]");
  bench.remaining_ms = 1000;
  const auto second = bench.command("move", "[2, 2]");
  bench.remaining_ms = 8000;
  const auto third = bench.command("move", "[3, 3]");
  CHECK(bench.sent() == "2 1 1 #");
  bench.live(1.1);
  CHECK(bench.answer(second) == "nack timeout");
  bench.program("2 1#");
  CHECK(bench.sent() == "2 3 3 #");
  bench.live(0.4);
  CHECK(bench.answer(third) == "ack started");
}

TEST_CASE("a skill ends with the answer of its move; meanwhile other commands are refused") {
  RapidBench bench;
  bench.deliver(MessageType::request, order("home", ""), "abb");
  bench.flags = kFlagTakeControl;
  CHECK(bench.answer(bench.command("move", "[1, 1]")) == "nack busy");
  bench.live(3);
  bench.program("2 0 joint%20error#");
  CHECK(bench.one<Outcome>().reason == "joint error");
}

TEST_CASE("a stop goes to the service task, whatever blocks the program") {
  RapidBench bench;
  bench.command("move", "[1, 1]");
  const auto waits = bench.command("move", "[2, 2]");
  bench.wait(0.25);
  CHECK(bench.written(Channel::monitor) == "90 #");
  const auto id = bench.deliver(MessageType::command, Stop{"test"});
  CHECK(bench.written(Channel::monitor) == "91 #");
  CHECK(bench.answer(waits) == "nack fenced");
  bench.service("90 1 0 1 1 0#91 1#");
  bench.live(0.1);
  CHECK(bench.answer(id) == "ack stopped");
  bench.program("2 0 stopped#");
  CHECK(bench.counted("refused.late_answer") == 1);
  const auto release = bench.deliver(MessageType::command, Release{});
  bench.live(0.1);
  CHECK(bench.answer(release) == "ack released");
}

TEST_CASE("a stop that is not confirmed is told so") {
  RapidBench bench;
  bench.confirms = false;
  const auto id = bench.deliver(MessageType::command, Stop{"test"});
  bench.live(2.1);
  CHECK(bench.nack_of(id).code == "timeout");
}

TEST_CASE("a skill that takes too long: its motion is ended, and its answer is late") {
  RapidBench bench;
  bench.deliver(MessageType::request, order("home", ""), "abb");
  bench.live(10.1);
  CHECK(bench.one<Outcome>().reason == "timed out after 10 s");
  CHECK(bench.turns == "91 #92 #");
  bench.sent();
  bench.flags = kFlagTakeControl;
  bench.command("move", "[1, 1]");
  CHECK(bench.sent().empty());
  bench.program("2 0 stopped#");
  CHECK(bench.sent() == "2 1 1 #");
  CHECK(bench.counted("refused.late_answer") == 1);
}

TEST_CASE("a program that never answers the move that was ended is dialled again") {
  RapidBench bench;
  bench.deliver(MessageType::request, order("home", ""), "abb");
  bench.live(15.3);
  CHECK(bench.closed().find("did not answer") != std::string::npos);
}

TEST_CASE("a fault: the service task's text, its capability and severity, told once") {
  RapidBench bench;
  bench.deliver(MessageType::request, order("home", ""), "abb");
  bench.state = "0 0 0 50204 grab%20URGENT%20arm%20%22hit%22";
  bench.live(0.3);
  const auto fault = bench.one<RobotFault>();
  CHECK(fault.capability == "grab");
  CHECK(fault.severity == Severity::urgent);
  CHECK(fault.text == "arm \"hit\"");
  bench.live(1.2);
  // The program has not answered: what it was at must not go on when the motors are on again.
  CHECK(bench.one<Outcome>().reason == "the robot's motors went off: grab URGENT arm \"hit\"");
  CHECK(bench.turns == "91 #92 #");
  bench.flags = kFlagTakeControl;
  CHECK(bench.nack_of(bench.command("move", "[1, 1]")).cure.find("panel") != std::string::npos);
  CHECK(bench.told<RobotFault>().empty());
}

TEST_CASE("a fault ends with the service task's error, and motors that went off with the motors") {
  RapidBench bench;
  bench.state = "0 0 0 0";
  bench.live(0.3);
  REQUIRE(bench.kept.size() == 1);
  bench.state = "0 0 0 50204 grab%20CRITICAL%20gripper%20lost";
  bench.live(0.3);
  CHECK(bench.kept.size() == 2);
  bench.state = "0 0 1 50204 grab%20CRITICAL%20gripper%20lost";
  bench.live(0.3);
  REQUIRE(bench.kept.size() == 1);
  CHECK(bench.kept[0].what.text == "gripper lost");
  bench.over();
  bench.state = "0 0 1 0";
  bench.live(0.3);
  CHECK(bench.over() == std::vector<std::string>{"grab: gripper lost"});
}

TEST_CASE("requests: the service task at any time, the program between moves") {
  RapidBench bench;
  const auto position = bench.send(MessageType::request, "position", "");
  const auto joints = bench.send(MessageType::request, "joints", "");
  const auto motors = bench.send(MessageType::request, "motors", "");
  bench.live(0.1);
  CHECK(bench.answer(position) == "[10.5,20,30]");
  CHECK(bench.answer(joints) == "[1.5,-2]");
  bench.command("move", "[1, 1]");
  CHECK(bench.answer(bench.send(MessageType::request, "position", "")) == "nack busy");
  const auto moving = bench.send(MessageType::request, "joints", "");
  bench.live(0.1);
  CHECK(bench.answer(moving) == "[1.5,-2]");
  CHECK(bench.counted("refused.unasked_answer") == 0);
  static_cast<void>(motors);
}

TEST_CASE("a service task that is silent for 2 s: the robot is gone, and what was under way is told so") {
  RapidBench bench;
  bench.deliver(MessageType::request, order("home", ""), "abb");
  bench.live(0.5);
  bench.wait(2.5);
  CHECK(bench.closed().find("service task") != std::string::npos);
  CHECK(bench.one<Outcome>().outcome == TaskOutcome::interrupted);
  bench.flags = kFlagTakeControl;
  CHECK(bench.answer(bench.command("move", "[1, 1]")) == "nack robot_offline");
}

TEST_CASE("the robot is there once both of its tasks are, whichever comes last, and whichever was lost alone") {
  for (const Channel last : {Channel::command, Channel::monitor}) {
    for (const bool restarts : {false, true}) {
      CAPTURE(name_of(last));
      CAPTURE(restarts);
      RapidBench bench;
      bench.welcome();
      bench.told<AdapterState>();
      bench.down(last);
      if (restarts) bench.down(last == Channel::command ? Channel::monitor : Channel::command);
      CHECK(bench.one<AdapterState>().robot == "CONNECTION_BROKEN");
      if (restarts) bench.up(last == Channel::command ? Channel::monitor : Channel::command);
      bench.live(0.5);
      CHECK(bench.told<AdapterState>().empty());
      bench.up(last);
      bench.live(0.5);
      CHECK(bench.one<AdapterState>().robot == "ONLINE");
      bench.flags = kFlagTakeControl;
      const auto id = bench.command("move", "[1, 1]");
      CHECK(bench.sent() == "2 1 1 #");
      static_cast<void>(id);
    }
  }
}

TEST_CASE("an answer of another code: the two sides are out of step, and the connection is closed") {
  RapidBench bench;
  const auto id = bench.command("move", "[1, 1]");
  bench.program("4 1 2 3#");
  CHECK(bench.closed().find("answered 4 to request 2") != std::string::npos);
  CHECK(bench.answer(id) == "nack robot_offline");
  RapidBench calm;
  calm.program("2 1#");
  CHECK(calm.counted("refused.unasked_answer") == 1);
}
