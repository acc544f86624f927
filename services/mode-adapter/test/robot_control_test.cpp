// Who may command the robot: the fence before the lease, and what keeps the lease alive.
#include "services/mode-adapter/core/robot_control.hpp"

#include "services/mode-adapter/test/fixture.hpp"

using namespace trb;
using namespace trb::adapter;

namespace {

const Holder kOperator{Holder::Kind::person, "operator"};
const Holder kCloud{Holder::Kind::person, "cloud"};
const Holder kRun{Holder::Kind::run, "r-1"};

struct RobotControlBench {
  explicit RobotControlBench(bool fenced = false) : robot(settings(fenced)) {}
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
  RobotControlBench bench(true);
  const auto barred = bench.control.barred(kOperator, true, bench.now);
  REQUIRE(barred);
  CHECK(barred->code == Errc::fenced);
  CHECK(barred->hint == "trb release pioneer");
}

TEST_CASE("another one is barred until it takes the control over, which is told") {
  RobotControlBench bench;
  CHECK_FALSE(bench.control.barred(kOperator, false, bench.now));
  bench.control.take(kOperator, bench.now, bench.out);
  CHECK(bench.control.barred(kCloud, false, bench.now)->code == Errc::control_held);
  CHECK_FALSE(bench.control.barred(kCloud, true, bench.now));
  CHECK(bench.out.counts.empty());
  bench.control.take(kCloud, bench.now, bench.out);
  CHECK(bench.out.counts == std::vector<std::string>{"control.taken_over"});
  CHECK(bench.control.holder()->name == "cloud");
}

TEST_CASE("a run holds the robot while its skill runs, and ten seconds longer") {
  RobotControlBench bench;
  bench.control.take(kRun, bench.now, bench.out);
  bench.later(60);
  bench.control.refresh(true, false, bench.now);
  CHECK(bench.control.holder());
  bench.control.refresh(false, false, bench.now);
  CHECK(bench.control.holder());
  bench.later(10);
  bench.control.refresh(false, false, bench.now);
  CHECK_FALSE(bench.control.holder());
}

TEST_CASE("a person's lease does not live on a run's skill") {
  RobotControlBench bench;
  bench.control.take(kOperator, bench.now, bench.out);
  bench.control.began(bench.robot.field(), 1);
  bench.later(10);
  bench.control.refresh(true, false, bench.now);
  CHECK_FALSE(bench.control.holder());
}
