// A virtual robot is ordered to fail; its fault comes back like any robot's.
#include "services/mode-adapter/test/fixture.hpp"

using namespace trb;
using namespace trb::adapter;

namespace {

/// The adapter of a virtual robot, and the lines that its control port received.
struct Virtual {
  std::vector<std::string> lines;
  Status port = Done{};
  Outbox out;
  ModeAdapterCore core{ur3(), [](bool) { return Status(Done{}); },
                       [](const std::vector<Kept>&) { return Status(Done{}); },
                       [this](const std::string& line) {
                         lines.push_back(line);
                         return port;
                       }};

  void ask(const InjectFault& order) {
    core.on({MessageType::command, "operator", "ur3", 1, 0, 0, 5000, order}, Now{}, out);
  }
};

}  // namespace

TEST_CASE("a fault by word goes to the virtual robot as one line, whatever the text") {
  Virtual robot;
  robot.ask({"grab", Severity::critical, "gripper \"jammed\"\nC:\\x"});
  CHECK(robot.lines == std::vector<std::string>{"fault grab CRITICAL gripper \"jammed\"\\nC:\\\\x"});
  CHECK(sent<Ack>(robot.out).at(0).state == "handed_over");
  robot.ask({});
  CHECK(robot.lines.back() == "clear");
}

TEST_CASE("a capability that the robot does not have is refused, and the ones there are are named") {
  Virtual robot;
  robot.ask({"fly", Severity::fatal, ""});
  CHECK(robot.lines.empty());
  const Nack nack = sent<Nack>(robot.out).at(0);
  CHECK(nack.what == "'ur3' has no capability 'fly'");
  CHECK(nack.hint == "use one of: grab, reach");
}

TEST_CASE("a real robot is not made to fail") {
  Fixture fixture(ur3());
  fixture.deliver(MessageType::command, InjectFault{"grab", Severity::fatal, ""});
  const Nack nack = sent<Nack>(fixture.out).at(0);
  CHECK(nack.code == "not_permitted");
  CHECK(nack.hint.find("fault_injection") != std::string::npos);
}

TEST_CASE("a control port that cannot be reached is told") {
  Virtual robot;
  robot.port = fail(Errc::io_error, "no way", "look");
  robot.ask({"grab", Severity::fatal, ""});
  CHECK(sent<Nack>(robot.out).at(0).code == "io_error");
}
