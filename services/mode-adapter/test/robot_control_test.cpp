// Who may command the robot: the fence before the lease, and what keeps the lease alive.
#include "services/mode-adapter/core/robot_control.hpp"

#include "services/mode-adapter/test/fixture.hpp"

using namespace trb;
using namespace trb::adapter;

namespace {

const Holder kOperator{Holder::Kind::person, "operator"};
const Holder kCloud{Holder::Kind::person, "cloud"};
const Holder kRun{Holder::Kind::run, "r-1"};

struct RobotControlFixture {
  explicit RobotControlFixture(bool fenced = false) : robot(settings(fenced)) {}
  static Settings settings(bool fenced) {
    Settings all = pioneer();
    all.fenced = fenced;
    return all;
  }
  void later(double time_s) { now.mono = now.mono + seconds(time_s); }

  Now now{MonotonicTime{} + seconds(100), UtcTime{}};
  Outbox out;
  RobotSide robot;
  StopControl stops{robot, [](bool) { return Status(Done{}); }};
  RobotControl control{stops, "pioneer"};
};

}  // namespace

TEST_CASE("nobody commands a fenced robot, by word neither") {
  RobotControlFixture fixture(true);
  const auto barred = fixture.control.barred(kOperator, true, fixture.now);
  REQUIRE(barred);
  CHECK(barred->code == Errc::fenced);
  CHECK(barred->hint == "trb release pioneer");
}

TEST_CASE("another one is barred until it takes the control over, which is told") {
  RobotControlFixture fixture;
  CHECK_FALSE(fixture.control.barred(kOperator, false, fixture.now));
  fixture.control.take(kOperator, fixture.now, fixture.out);
  CHECK(fixture.control.barred(kCloud, false, fixture.now)->code == Errc::control_held);
  CHECK_FALSE(fixture.control.barred(kCloud, true, fixture.now));
  CHECK(fixture.out.counts.empty());
  fixture.control.take(kCloud, fixture.now, fixture.out);
  CHECK(fixture.out.counts == std::vector<std::string>{"control.taken_over"});
  CHECK(fixture.control.holder()->name == "cloud");
}

TEST_CASE("a run holds the robot while its skill runs, and ten seconds longer") {
  RobotControlFixture fixture;
  fixture.control.take(kRun, fixture.now, fixture.out);
  fixture.later(60);
  fixture.control.refresh(true, false, fixture.now);
  CHECK(fixture.control.holder());
  fixture.control.refresh(false, false, fixture.now);
  CHECK(fixture.control.holder());
  fixture.later(10);
  fixture.control.refresh(false, false, fixture.now);
  CHECK_FALSE(fixture.control.holder());
}

TEST_CASE("a person's lease does not live on a run's skill") {
  RobotControlFixture fixture;
  fixture.control.take(kOperator, fixture.now, fixture.out);
  fixture.control.began(fixture.robot.field(), 1);
  fixture.later(10);
  fixture.control.refresh(true, false, fixture.now);
  CHECK_FALSE(fixture.control.holder());
}
