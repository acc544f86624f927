// What becomes of a RAPID server's moves that are stopped or halted: confirmed, refused, lost, released.
#include <vector>

#include "common/drivers/rapid/test/fixture.hpp"

using namespace trb;
using namespace trb::adapter;

namespace {

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
