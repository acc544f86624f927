// The direct mode for a RAPID server: moves that block, and a service task beside them.
#include "common/drivers/rapid/wire.hpp"
#include "services/mode-adapter/test/fixture.hpp"

using namespace trb;
using namespace trb::adapter;

namespace {

Settings abb() {
  Settings settings = robot_settings("abb", "abb", Mode::direct, "rapid");
  settings.description.capabilities = {"grab", "reach"};
  settings.description.skills = {make_skill("home", "")};
  settings.commands.port = 5000;
  settings.commands.monitor = Monitor{"rapid-service", 5001};
  settings.commands.commands = {{"move", "2 {0} {1}"}, {"pick", "2 {0} {1}\n20 1"}, {"home", "2 0 0"},
                                {"show", "40 {data}"}, {"stop", "service 91"},      {"release", "service 92"}};
  settings.commands.values = {{"joints", "service 4 0 1"}, {"position", "3 0 1 2"}};
  settings.commands.requests = {{"joints", "joints"}, {"position", "position"}, {"motors", "motors"}};
  return settings;
}

/// Both connections are up, the service task has reported its state, and nothing is running.
class RapidFixture : public Fixture {
 public:
  explicit RapidFixture(Settings settings = abb()) : Fixture(std::move(settings)) {
    up(Channel::command);
    up(Channel::monitor);
    live(0.05);
  }
  void program(const std::string& text) { hear(Channel::command, text); }
  void service(const std::string& text) { hear(Channel::monitor, text); }
  /// Advances time; the service task and the values are answered at once, the program's other requests are kept.
  void live(double time_s) {
    const auto steps = static_cast<int>(time_s / 0.05 + 0.999);
    for (int i = 0; i < steps; ++i) {
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

/// A move home that was cancelled; the service task does not confirm it by itself.
struct Cancelled : RapidFixture {
  Cancelled() {
    confirms = false;
    deliver(MessageType::request, order("home", ""), "abb");
    live(1);
    deliver(MessageType::command, CancelExecution{attempt(), "enough"}, "abb");
  }
};

}  // namespace

TEST_CASE("answers: in pieces, ended by # or a line end, or by a moment's silence") {
  RapidReader reader;
  MonotonicTime now{1};
  reader.add("2 ", now);
  CHECK_FALSE(reader.next(now));
  reader.add("1#\n4 1 1\n", now);
  CHECK(*reader.next(now) == "2 1");
  CHECK(*reader.next(now) == "4 1 1");
  CHECK_FALSE(reader.next(now));
  RapidReader endless;
  endless.add("4 1 1", now);
  CHECK_FALSE(endless.next(now));
  CHECK(*endless.next(now + seconds(0.1)) == "4 1 1");
  const auto answer = read_rapid_answer("4 1 1.5 -2e1 x%20%22y%22");
  CHECK(answer->numbers == std::vector<double>{1.5, -20});
  CHECK(answer->text == "1.5 -2e1 x \"y\"");
  for (const char* bad : {"", "x", "2", "-1 1", "1.5 1", "99999 1"})
    CHECK_FALSE_MESSAGE(read_rapid_answer(bad).ok(), bad);
}

TEST_CASE("answers: a server that has ended one itself ends each; a pause inside one ends none") {
  RapidReader reader;
  MonotonicTime now{1};
  reader.add("90 1 0 0 1 0#", now);
  CHECK(*reader.next(now) == "90 1 0 0 1 0");
  reader.add("90 1 0 0 1 41", now);
  now = now + seconds(0.3);
  CHECK_FALSE(reader.next(now));
  CHECK_FALSE(reader.next_deadline());
  reader.add(" arm WARNING x#", now);
  CHECK(*reader.next(now) == "90 1 0 0 1 41 arm WARNING x");
  reader.clear();  // another connection, and maybe another server
  reader.add("2 1", now);
  CHECK(*reader.next(now + seconds(0.1)) == "2 1");
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
  RapidFixture fixture;
  const auto id = fixture.command("move", "[10, -20.5]");
  CHECK(fixture.sent() == "2 10 -20.5 #");
  CHECK(fixture.answer(id).empty());
  fixture.live(0.4);
  CHECK(fixture.answer(id) == "ack started");
  fixture.program("2 ");
  fixture.program("1#");
  CHECK(fixture.counted("from_robot.done") == 1);
}

TEST_CASE("what the robot refuses is told with its text") {
  RapidFixture fixture;
  const auto id = fixture.command("move", "[10, 200]");
  fixture.program("2 0 J2%20200%20is%20out%20of%20its%20range#");
  CHECK(fixture.nack_of(id).what == "the robot refuses it: J2 200 is out of its range");
  CHECK(fixture.nack_of(fixture.command("move", "[1]")).what == "the command takes 2 items, and the data has 1");
}

TEST_CASE("a text of more than 80 characters is refused, and one with a quote or a newline ends nothing") {
  RapidFixture fixture;
  const auto id = fixture.command("show", '"' + std::string(76, 'x') + '"');
  CHECK(fixture.nack_of(id).code == "too_large");
  CHECK(fixture.nack_of(id).what == "the request has 81 characters, and a RAPID string holds 80");
  fixture.command("show", R"("a\"\n# 91 #")");
  CHECK(fixture.sent() == "40 a%22%0A%23%2091%20%23 #");
}

TEST_CASE("a command of several requests: each waits for the answer of the one before") {
  RapidFixture fixture;
  fixture.command("pick", "[1, 2]");
  CHECK(fixture.sent() == "2 1 2 #");
  fixture.program("2 1#");
  CHECK(fixture.sent() == "20 1 #");
  fixture.program("20 1#");
  CHECK(fixture.counted("from_robot.done") == 1);
}

TEST_CASE("two commands at once: the second waits for the end of the first, or for its own deadline") {
  RapidFixture fixture;
  fixture.command("move", "[1, 1]");
  fixture.remaining_ms = 1000;
  const auto second = fixture.command("move", "[2, 2]");
  fixture.remaining_ms = 8000;
  const auto third = fixture.command("move", "[3, 3]");
  CHECK(fixture.sent() == "2 1 1 #");
  fixture.live(1.1);
  CHECK(fixture.answer(second) == "nack timeout");
  fixture.program("2 1#");
  CHECK(fixture.sent() == "2 3 3 #");
  fixture.live(0.4);
  CHECK(fixture.answer(third) == "ack started");
}

TEST_CASE("a skill ends with the answer of its move; meanwhile other commands are refused") {
  RapidFixture fixture;
  fixture.deliver(MessageType::request, order("home", ""), "abb");
  fixture.flags = kFlagTakeControl;
  CHECK(fixture.answer(fixture.command("move", "[1, 1]")) == "nack busy");
  fixture.live(3);
  fixture.program("2 0 joint%20error#");
  CHECK(fixture.one<Outcome>().reason == "joint error");
}

TEST_CASE("a stop goes to the service task, whatever blocks the program") {
  RapidFixture fixture;
  fixture.command("move", "[1, 1]");
  const auto waits = fixture.command("move", "[2, 2]");
  fixture.wait(0.25);
  CHECK(fixture.written(Channel::monitor) == "90 #");
  const auto id = fixture.deliver(MessageType::command, Stop{"test"});
  CHECK(fixture.written(Channel::monitor) == "91 #");
  CHECK(fixture.answer(waits) == "nack fenced");
  fixture.service("90 1 0 1 1 0#91 1#");
  fixture.live(0.1);
  CHECK(fixture.answer(id) == "ack stopped");
  fixture.program("2 0 stopped#");
  CHECK(fixture.counted("refused.late_answer") == 1);
  const auto release = fixture.deliver(MessageType::command, Release{});
  fixture.live(0.1);
  CHECK(fixture.answer(release) == "ack released");
}

TEST_CASE("a stop that is not confirmed is told so") {
  RapidFixture fixture;
  fixture.confirms = false;
  const auto id = fixture.deliver(MessageType::command, Stop{"test"});
  fixture.live(2.1);
  CHECK(fixture.nack_of(id).code == "timeout");
}

TEST_CASE("a skill that takes too long: its motion is ended, and its answer is late") {
  RapidFixture fixture;
  fixture.deliver(MessageType::request, order("home", ""), "abb");
  fixture.live(10.1);
  CHECK(fixture.one<Outcome>().reason == "timed out after 10 s");
  CHECK(fixture.turns == "91 #92 #");
  fixture.sent();
  fixture.flags = kFlagTakeControl;
  fixture.command("move", "[1, 1]");
  CHECK(fixture.sent().empty());
  fixture.program("2 0 stopped#");
  CHECK(fixture.sent() == "2 1 1 #");
  CHECK(fixture.counted("refused.late_answer") == 1);
}

TEST_CASE("a move that came to its end before the service task has confirmed its halt has finished") {
  Cancelled fixture;
  fixture.live(0.1);
  CHECK(fixture.turns == "91 #");
  CHECK(fixture.told<Outcome>().empty());
  fixture.program("2 1#");
  CHECK(fixture.one<Outcome>().outcome == TaskOutcome::finished);
}

TEST_CASE("a service task that refuses a halt: nobody knows") {
  Cancelled fixture;
  fixture.live(0.1);
  fixture.service("91 0 not now#");
  CHECK(fixture.one<Outcome>().outcome == TaskOutcome::interrupted);
}

TEST_CASE("a halt, or the release behind it, that is refused is a fault until one is taken, and commands go on") {
  for (const bool release : {false, true}) {
    Cancelled fixture;
    fixture.live(0.1);
    if (release) fixture.service("91 1#");
    fixture.serve();
    CHECK(fixture.turns == (release ? "91 #92 #" : "91 #"));
    fixture.service(release ? "92 0 not now#" : "91 0 not now#");
    const auto faults = fixture.told<RobotFault>();
    REQUIRE(faults.size() == 2);  // a capability each
    CHECK(get<RobotFault>(faults[0].body).severity == Severity::critical);
    CHECK(get<RobotFault>(faults[0].body).text ==
          std::string("the robot refuses to ") +
              (release ? "go on: not now" : "stop: not now; it may stand in its stop: stop and release it"));
    fixture.program("2 0 stopped#");
    fixture.sent();
    fixture.flags = kFlagTakeControl;
    fixture.command("move", "[1, 1]");
    CHECK(fixture.sent() == "2 1 1 #");
    CHECK(fixture.kept.size() == 1);
    fixture.confirms = true;
    if (release) {
      fixture.deliver(MessageType::command, Release{}, "operator");
    } else {
      fixture.deliver(MessageType::command, Stop{}, "operator");
    }
    fixture.live(0.1);
    CHECK(fixture.kept.empty());
  }
}

TEST_CASE("a robot that may stand in the stop of a halt is released when the link is back") {
  for (const bool release : {false, true}) {
    Cancelled fixture;
    fixture.live(0.1);
    fixture.service(release ? "91 1#" : "91 0 not now#");
    fixture.serve();
    fixture.down(Channel::monitor, "gone");
    fixture.turns.clear();
    fixture.confirms = true;
    fixture.up(Channel::monitor);
    fixture.live(0.1);
    CHECK(fixture.turns == (release ? "92 #" : "92 #91 #92 #"));  // a halt that was refused is owed
    fixture.down(Channel::monitor, "gone");
    fixture.turns.clear();
    fixture.up(Channel::monitor);
    fixture.live(0.1);
    CHECK(fixture.turns.empty());
  }
}

TEST_CASE("a release that a robot in no stop refuses is no fault; a halt is given, and commands go on") {
  RapidFixture fixture;
  fixture.confirms = false;
  fixture.deliver(MessageType::request, order("home", ""), "abb");
  fixture.live(1);
  const auto release = fixture.deliver(MessageType::command, Release{}, "operator");
  fixture.serve();
  fixture.service("92 0 not stopped#");
  CHECK(fixture.told<RobotFault>().empty());
  CHECK(fixture.kept.empty());
  fixture.deliver(MessageType::command, CancelExecution{attempt(), "enough"}, "abb");
  fixture.serve();
  CHECK(fixture.turns == "92 #91 #");
  CHECK(fixture.told<Outcome>().empty());
  fixture.service("91 1#");
  CHECK(fixture.one<Outcome>().outcome == TaskOutcome::failed);
  fixture.serve();
  fixture.service("92 1#");
  fixture.live(2);
  CHECK(fixture.answer(release) == "nack timeout");
  fixture.program("2 0 stopped#");
  fixture.sent();
  fixture.deliver(MessageType::command, Release{}, "operator");
  fixture.serve();
  fixture.service("92 0 not stopped#");
  fixture.flags = kFlagTakeControl;
  fixture.command("move", "[1, 1]");
  CHECK(fixture.sent() == "2 1 1 #");
}

TEST_CASE("a refused release of a robot in its stop is a fault") {
  RapidFixture fixture;
  fixture.deliver(MessageType::command, Stop{}, "operator");
  fixture.live(0.1);
  fixture.confirms = false;
  fixture.deliver(MessageType::command, Release{}, "operator");
  fixture.serve();
  fixture.service("92 0 not now#");
  CHECK(fixture.told<RobotFault>().size() == 2);  // a capability each
}

TEST_CASE("a halt that is lost with the connection is given again before all else") {
  Cancelled fixture;
  fixture.live(2.5);
  CHECK(fixture.one<Outcome>().outcome == TaskOutcome::interrupted);
  fixture.turns.clear();
  fixture.confirms = true;
  fixture.up(Channel::monitor);
  fixture.down(Channel::command, "gone");
  fixture.up(Channel::command);
  fixture.live(0.1);
  CHECK(fixture.turns == "91 #92 #");
  CHECK(fixture.answer(fixture.deliver(MessageType::command, order("home", "", 2), "abb")) == "running");
}

TEST_CASE("a halt in whose place came a stop, and neither was confirmed: it is given behind the release of that stop") {
  Cancelled fixture;
  fixture.live(0.1);
  fixture.deliver(MessageType::command, Stop{"fire"}, "operator");
  fixture.live(0.1);
  CHECK(fixture.one<Outcome>().outcome == TaskOutcome::interrupted);
  fixture.down(Channel::monitor, "gone");
  fixture.deliver(MessageType::command, Release{"all clear"}, "operator");
  fixture.turns.clear();
  fixture.up(Channel::monitor);
  fixture.live(0.05);
  CHECK(fixture.turns == "92 #");
  const auto execute = [&] { return fixture.deliver(MessageType::command, order("home", "", 2), "abb"); };
  CHECK(fixture.answer(execute()) == "nack busy");
  fixture.service("92 1#");
  fixture.live(0.05);
  CHECK(fixture.turns == "92 #91 #");
  CHECK(fixture.answer(execute()) == "nack busy");
  fixture.confirms = true;
  fixture.service("91 1#");
  fixture.live(0.05);
  CHECK(fixture.turns == "92 #91 #92 #");
  CHECK(fixture.answer(execute()) == "running");
}

TEST_CASE("a program that never answers the move that was ended is dialled again") {
  RapidFixture fixture;
  fixture.deliver(MessageType::request, order("home", ""), "abb");
  fixture.live(15.3);
  CHECK(fixture.closed().find("did not answer") != std::string::npos);
}

TEST_CASE("a fault: the service task's text, its capability and severity, told once") {
  RapidFixture fixture;
  fixture.deliver(MessageType::request, order("home", ""), "abb");
  fixture.state = "0 0 0 50204 grab%20URGENT%20arm%20%22hit%22";
  fixture.live(0.3);
  const auto fault = fixture.one<RobotFault>();
  CHECK(fault.capability == "grab");
  CHECK(fault.severity == Severity::urgent);
  CHECK(fault.text == "arm \"hit\"");
  fixture.live(1.2);
  // The program has not answered: its command must not go on when the motors are on again.
  CHECK(fixture.one<Outcome>().reason == "the robot's motors went off: grab URGENT arm \"hit\"");
  CHECK(fixture.turns == "91 #92 #");
  fixture.flags = kFlagTakeControl;
  CHECK(fixture.nack_of(fixture.command("move", "[1, 1]")).hint.find("panel") != std::string::npos);
  CHECK(fixture.told<RobotFault>().empty());
}

TEST_CASE("a fault ends with the service task's error, and motors that went off with the motors") {
  RapidFixture fixture;
  fixture.state = "0 0 0 0";
  fixture.live(0.3);
  REQUIRE(fixture.kept.size() == 1);
  fixture.state = "0 0 0 50204 grab%20CRITICAL%20gripper%20lost";
  fixture.live(0.3);
  CHECK(fixture.kept.size() == 2);
  fixture.state = "0 0 1 50204 grab%20CRITICAL%20gripper%20lost";
  fixture.live(0.3);
  REQUIRE(fixture.kept.size() == 1);
  CHECK(fixture.kept[0].what.text == "gripper lost");
  fixture.over();
  fixture.state = "0 0 1 0";
  fixture.live(0.3);
  CHECK(fixture.over() == std::vector<std::string>{"grab: gripper lost"});
}

TEST_CASE("requests: the service task at any time, the program between moves") {
  RapidFixture fixture;
  const auto position = fixture.send(MessageType::request, "position", "");
  const auto joints = fixture.send(MessageType::request, "joints", "");
  const auto motors = fixture.send(MessageType::request, "motors", "");
  fixture.live(0.1);
  CHECK(fixture.answer(position) == "[10.5,20,30]");
  CHECK(fixture.answer(joints) == "[1.5,-2]");
  fixture.command("move", "[1, 1]");
  CHECK(fixture.answer(fixture.send(MessageType::request, "position", "")) == "nack busy");
  const auto moving = fixture.send(MessageType::request, "joints", "");
  fixture.live(0.1);
  CHECK(fixture.answer(moving) == "[1.5,-2]");
  CHECK(fixture.counted("refused.unasked_answer") == 0);
  static_cast<void>(motors);
}

TEST_CASE("a member that asks without end hides neither the service task's state nor keeps a command waiting") {
  RapidFixture fixture;
  fixture.serve();
  const auto ask = [&](const char* what) { return fixture.send(MessageType::request, what, "", "nosy"); };
  for (int i = 0; i < 5; ++i) ask("joints");
  CHECK(fixture.written(Channel::monitor) == "4 #");
  fixture.wait(0.25);
  fixture.service("4 1 1.5 -2#");
  CHECK(fixture.written(Channel::monitor) == "90 #");
  fixture.state = "0 0 0 0";
  fixture.service("90 1 " + fixture.state + "#");
  fixture.serve();
  CHECK_FALSE(fixture.told<RobotFault>().empty());

  RapidFixture other;
  other.live(0.1);
  for (int i = 0; i < 3; ++i) other.send(MessageType::request, "position", "", "nosy");
  CHECK(other.written(Channel::command) == "3 #");
  other.deliver(MessageType::request, order("home", ""), "abb");
  CHECK(other.written(Channel::command).empty());
  other.program("3 1 10.5 20 30#");
  CHECK(other.written(Channel::command) == "2 0 0 #");
  other.program("2 1#");
  CHECK(other.one<Outcome>().outcome == TaskOutcome::finished);
  CHECK(other.written(Channel::command) == "3 #");
}

TEST_CASE("requests that are forgotten leave the queue of their task") {
  RapidFixture fixture;
  fixture.serve();
  const auto kept = fixture.send(MessageType::request, "joints", "");
  CHECK(fixture.written(Channel::monitor) == "4 #");
  fixture.remaining_ms = 100;
  for (int i = 0; i < 60; ++i) fixture.send(MessageType::request, "joints", "", "nosy");
  fixture.wait(0.15);
  fixture.service("4 1 1.5 -2#");
  CHECK(fixture.answer(kept) == "[1.5,-2]");
  CHECK(fixture.written(Channel::monitor).find("4 #") == std::string::npos);
}

TEST_CASE("a service task that is silent for 2 s: the robot is gone, and what was under way is told so") {
  RapidFixture fixture;
  fixture.deliver(MessageType::request, order("home", ""), "abb");
  fixture.live(0.5);
  fixture.wait(2.5);
  CHECK(fixture.closed().find("service task") != std::string::npos);
  CHECK(fixture.one<Outcome>().outcome == TaskOutcome::interrupted);
  fixture.flags = kFlagTakeControl;
  CHECK(fixture.answer(fixture.command("move", "[1, 1]")) == "nack robot_offline");
}

TEST_CASE("the robot is there once both of its tasks are, whichever comes last, and whichever was lost alone") {
  for (const Channel last : {Channel::command, Channel::monitor}) {
    for (const bool restarts : {false, true}) {
      CAPTURE(name_of(last));
      CAPTURE(restarts);
      RapidFixture fixture;
      fixture.welcome();
      fixture.told<AdapterState>();
      fixture.down(last);
      if (restarts) fixture.down(last == Channel::command ? Channel::monitor : Channel::command);
      CHECK(fixture.one<AdapterState>().robot == "CONNECTION_BROKEN");
      if (restarts) fixture.up(last == Channel::command ? Channel::monitor : Channel::command);
      fixture.live(0.5);
      CHECK(fixture.told<AdapterState>().empty());
      fixture.up(last);
      fixture.live(0.5);
      CHECK(fixture.one<AdapterState>().robot == "ONLINE");
      fixture.flags = kFlagTakeControl;
      const auto id = fixture.command("move", "[1, 1]");
      CHECK(fixture.sent() == "2 1 1 #");
      static_cast<void>(id);
    }
  }
}

TEST_CASE("an answer of another code: the two sides are out of step, and the connection is closed") {
  RapidFixture fixture;
  const auto id = fixture.command("move", "[1, 1]");
  fixture.program("4 1 2 3#");
  CHECK(fixture.closed().find("answered 4 to request 2") != std::string::npos);
  CHECK(fixture.answer(id) == "nack robot_offline");
  RapidFixture calm;
  calm.program("2 1#");
  CHECK(calm.counted("refused.unasked_answer") == 1);
}

TEST_CASE("releases without end: a further one joins the one that the service task has not come to") {
  RapidFixture fixture;
  fixture.confirms = false;
  std::vector<std::uint64_t> releases;
  for (int i = 0; i < 64; ++i) releases.push_back(fixture.deliver(MessageType::command, Release{}, "operator"));
  fixture.serve();
  CHECK(fixture.turns == "92 #92 #");
  fixture.service("92 1#");
  CHECK(fixture.answer(releases.front()).empty());  // it gave way to the second
  fixture.service("92 1#");
  for (const std::uint64_t id : releases) CHECK(fixture.answer(id) == "ack released");

  fixture.deliver(MessageType::command, Stop{}, "operator");
  const auto last = fixture.deliver(MessageType::command, Release{}, "operator");
  fixture.serve();
  CHECK(fixture.turns == "92 #92 #91 #92 #");  // never before a stop
  fixture.service("91 1#");
  fixture.service("92 1#");
  CHECK(fixture.answer(last) == "ack released");
}
