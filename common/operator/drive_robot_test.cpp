#include "common/operator/drive_robot.hpp"

#include "common/operator/test/fake_node.hpp"

using namespace trb;
using namespace trb::op;

namespace {

constexpr auto kDriveTenth = std::chrono::milliseconds(100);

struct DriveFixture {
  FakeNode node;
  Ending<DriveReport> ending;

  explicit DriveFixture(Duration lasts, bool take = false) {
    drive_robot(node.session(), {"pioneer", DrivePart::base, {0.2, 0.1}, lasts, take, "ada"}, ending);
  }
  Velocity next() { return node.take<Velocity>("pioneer"); }
};

}  // namespace

TEST_CASE("speeds go out every 100 ms, and at the end that the person lets go") {
  DriveFixture driving(std::chrono::milliseconds(250));
  const Velocity first = driving.next();
  CHECK(first.speeds == std::vector{0.2, 0.1});
  CHECK(first.by == "ada");
  CHECK(first.drive != 0);
  CHECK(first.sequence == 1);
  CHECK_FALSE(first.over);
  driving.node.answer(Ack{"driving", ""});
  CHECK(driving.node.is_quiet());
  driving.node.pass(kDriveTenth);
  CHECK(driving.next().sequence == 2);
  driving.node.pass(std::chrono::milliseconds(20));
  driving.node.answer(Ack{"driving", ""});
  driving.node.pass(std::chrono::milliseconds(80));
  CHECK(driving.next().sequence == 3);  // stays unanswered
  driving.node.pass(kDriveTenth);
  const Velocity last = driving.next();
  CHECK(last.over);
  CHECK(last.drive == first.drive);
  CHECK(last.sequence == 4);
  CHECK_FALSE(driving.ending.has_come());
  driving.node.answer(Ack{"over", ""});
  CHECK(driving.ending.value().sent == 4);
  REQUIRE(driving.ending.value().round_trips.size() == 3);
  CHECK(driving.ending.value().round_trips[1] == doctest::Approx(20));
  driving.node.pass(std::chrono::seconds(10));
  CHECK(driving.node.is_quiet());
}

TEST_CASE("a refusal ends it, and nothing is sent after it") {
  DriveFixture driving(std::chrono::seconds(5));
  driving.next();
  driving.node.refuse(Errc::control_held, "'office' has controlled pioneer for 3 s", "wait");
  CHECK(driving.ending.error().code == Errc::control_held);
  driving.node.pass(std::chrono::seconds(1));
  CHECK(driving.node.is_quiet());
}

TEST_CASE("control is taken once: who takes it back keeps it") {
  DriveFixture driving(std::chrono::seconds(5), true);
  CHECK(driving.next().take);
  driving.node.pass(kDriveTenth);
  CHECK_FALSE(driving.next().take);
}

TEST_CASE("an end that nobody confirms is an error that says so") {
  DriveFixture driving(Duration::zero());
  CHECK(driving.next().over);
  driving.node.pass(std::chrono::seconds(2));
  CHECK(driving.ending.error().code == Errc::timeout);
}

TEST_CASE("a router that takes nothing is an error") {
  FakeNode node;
  node.close();
  Ending<DriveReport> ending;
  drive_robot(node.session(), {"pioneer", DrivePart::base, {}, std::chrono::seconds(1), false, "ada"}, ending);
  CHECK_FALSE(ending.has_come());
  node.pass(Duration::zero());
  CHECK(ending.error().code == Errc::queue_full);
}
