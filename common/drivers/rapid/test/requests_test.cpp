// Values that members request of an ABB: its service task at any time, its program between moves.
#include "common/drivers/rapid/test/fixture.hpp"

using namespace trb;
using namespace trb::adapter;

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
