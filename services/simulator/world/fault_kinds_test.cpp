// Each kind of fault: what it does to the network, a clock, a disk or a robot, and what the fleet makes of it.
#include "services/simulator/world/test/plans.hpp"

using namespace trb;
using namespace trb::world;
using namespace trb::world::test;

namespace {

Fault cut_of(double at_s, const std::string& node, const std::string& other, Way way) {
  Fault out{at_s, FaultKind::cut, node, other};
  out.way = way;
  return out;
}

Fault clock_of(const std::string& node, const ClockFault& clock) {
  Fault out{.kind = FaultKind::clock, .node = node, .from_start = true};
  out.clock = clock;
  return out;
}

Fault on_sides(double at_s, FaultKind kind, std::vector<std::string> nodes) {
  Fault out{.at_s = at_s, .kind = kind};
  out.nodes = std::move(nodes);
  return out;
}

}  // namespace

TEST_CASE(
    "fault: a link that is cut one way only lets nothing pass that matters, and the run goes on once it is healed") {
  for (const Way way : {Way::there, Way::back}) {
    CAPTURE(name_of(way));
    World world(plan_of(2, 4, {cut_of(2, "r0", "r1", way), {40, FaultKind::heal, "r0", "r1"}}));
    const Played is = world.play();
    check_all_done(is, 4);
    CHECK(is.makespan_s > 40);
  }
}

TEST_CASE("fault: a cut that is healed one way only is still a cut") {
  Fault half{20, FaultKind::heal, "r0", "r1"};
  half.way = Way::there;
  World world(plan_of(2, 4, {{2, FaultKind::cut, "r0", "r1"}, half, {60, FaultKind::heal, "r0", "r1"}}));
  const Played is = world.play();
  check_all_done(is, 4);
  CHECK(is.makespan_s > 60);
}

TEST_CASE("fault: a fleet in two parts goes on within each, and ends once they are one again") {
  World world(
      plan_of(4, 8, {on_sides(4, FaultKind::partition, {"r0", "r1"}), on_sides(60, FaultKind::heal, {"r0", "r1"})}));
  const Played is = world.play();
  check_all_done(is, 8);
  CHECK(is.makespan_s > 60);
}

namespace {

/// r0 and r1 never reach each other directly.
WorldPlan apart(std::vector<std::string> relays, std::vector<Fault> more = {}) {
  Fault cut = cut_of(0, "r0", "r1", Way::both);
  cut.from_start = true;
  more.push_back(cut);
  WorldPlan out = plan_of(3, 6, std::move(more));
  out.relays = std::move(relays);
  out.until_s = 135;
  return out;
}

}  // namespace

TEST_CASE("fault: without a relay two nodes that never reach each other hold up the run") {
  const Played is = World(apart({})).play();
  CHECK_FALSE(is.over_everywhere);
}

TEST_CASE("fault: what two nodes send that do not reach each other goes by the hub") {
  check_all_done(World(apart({"cloud"})).play(), 6);
}

TEST_CASE("fault: the hub that relays dies, and another relay takes its place until it is back") {
  World world(apart({"cloud", "r2"}, {{1, FaultKind::kill, "cloud"}, {60, FaultKind::start, "cloud"}}));
  const Played is = world.play();
  check_all_done(is, 6);
  CHECK(is.makespan_s < 50);
}

TEST_CASE("fault: a computer whose clock begins in 1970 takes part") {
  check_all_done(World(plan_of(3, 6, {clock_of("r1", {.is_1970 = true})})).play(), 6);
}

TEST_CASE("fault: a clock that is wrong by minutes, or drifts, changes nothing") {
  check_all_done(World(plan_of(3, 6,
                               {clock_of("r1", {.ahead_s = 300}), clock_of("r2", {.ahead_s = -300}),
                                clock_of("r0", {.drift_ppm = 500})}))
                     .play(),
                 6);
}

TEST_CASE("fault: a slow disk makes a run as much longer as its commits take") {
  const double usual_s = World(plan_of(2, 4)).play().makespan_s;
  Fault slow{.kind = FaultKind::disk, .node = "r1", .from_start = true};
  slow.commit_s = 0.5;
  const Played is = World(plan_of(2, 4, {slow})).play();
  check_all_done(is, 4);
  CHECK(is.makespan_s > usual_s + 1);
  CHECK(is.makespan_s < usual_s + 10);
}

namespace {

Fault battery_of(const std::string& node, const Battery& battery) {
  Fault out{.kind = FaultKind::battery, .node = node, .from_start = true};
  out.battery = battery;
  return out;
}

}  // namespace

TEST_CASE("fault: a battery lasts as long as its robot works, then another robot goes on") {
  // Three seconds a task: it is used up in r1's second one.
  World world(plan_of(3, 6, {battery_of("r1", {.percent = 40, .per_second = 10})}));
  const Played is = world.play();
  check_all_done(is, 6);
  std::set<std::uint32_t> attempts;
  for (const auto& [key, times] : world.witness().begun()) {
    if (key.task == "t4") attempts.insert(key.attempt);
  }
  CHECK(attempts.size() == 2);
  World enough(plan_of(3, 6, {battery_of("r1", {.percent = 100, .per_second = 10})}));
  check_all_done(enough.play(), 6);
  CHECK(enough.witness().begun().size() == 6);
}

TEST_CASE("fault: repair charges no battery: an empty one breaks its robot again until it is charged") {
  Fault charge{5, FaultKind::battery, "r1"};
  charge.battery = {.percent = 80, .per_second = 0};
  World world(plan_of(2, 2,
                      {battery_of("r1", {.percent = 0, .per_second = 0}),
                       {1, FaultKind::repair, "r1"},
                       charge,
                       {6, FaultKind::repair, "r1"}}));
  std::vector<double> failed_s;
  Robot& robot = *world.nodes().at("r1")->robot();
  robot.on_fail = [&] { failed_s.push_back(world.seconds_passed()); };
  const Played is = world.play();
  check_all_done(is, 2);
  REQUIRE(failed_s.size() == 2);
  CHECK(failed_s[0] < 0.2);
  CHECK(failed_s[1] - is.submitted_s > 0.99);
  CHECK(failed_s[1] - is.submitted_s < 1.2);
  CHECK_FALSE(robot.is_broken());
}

TEST_CASE("fault: the cloud asks what a battery has left, and gives the task to the robot with more") {
  struct Case {
    double r0, r2;
    const char* taken;
  };
  for (const Case& one : {Case{90, 25, "r0"}, Case{25, 90, "r2"}}) {
    CAPTURE(one.taken);
    World world(plan_of(
        3, 3,
        {battery_of("r0", {.percent = one.r0}), battery_of("r2", {.percent = one.r2}), {0.5, FaultKind::fail, "r1"}}));
    std::string by;
    Robot& robot = *world.nodes().at(one.taken)->robot();
    robot.on_begin = [&, then = robot.on_begin, &node = *world.nodes().at(one.taken)] {
      if (node.order().key.task == "t1") by = one.taken;
      then();
    };
    check_all_done(world.play(), 3);
    CHECK(by == one.taken);
  }
}

TEST_CASE("fault: the fleet hears what a battery has left") {
  World world(plan_of(2, 2, {battery_of("r1", {.percent = 50, .per_second = 2})}));
  std::uint64_t told = 0;
  world.meter().trace = [&](const Sending& sending, CostPhase) {
    told += sending.subtype == RobotState::kSubtype && sending.from == "r1" ? 1U : 0U;
  };
  check_all_done(world.play(), 2);
  CHECK(told > 1);
}

TEST_CASE("fault: robots break by chance and are repaired; the seed says when") {
  Fault rate{.kind = FaultKind::rate};
  rate.rate = {.between_s = 10, .repair_s = 2};
  const auto played = [&](std::uint64_t seed) {
    World world(plan_of(3, 12, {rate}, seed));
    const Played is = world.play();
    check_unbroken(is);
    return std::pair(world.meter().digest(), world.witness().begun().size());
  };
  CHECK(played(3) == played(3));
  CHECK(played(3).first != played(4).first);
  CHECK(played(3).second > 12);
}

TEST_CASE("fault: the times between failures have the mean that was asked for") {
  Dice dice(5);
  double sum = 0;
  constexpr int kDraws = 2000;
  for (int i = 0; i < kDraws; ++i) sum += time_to_failure(100, 1e6, dice).value_or(0);
  CHECK(sum / kDraws > 95);
  CHECK(sum / kDraws < 105);
  CHECK_FALSE(time_to_failure(100, 0.05, dice));
}

namespace {

/// How often r1, which has no task, broke in a run of so many seconds, its failures a second apart.
std::size_t failures_in(double run_s, std::optional<double> repair_s) {
  Fault rate{.kind = FaultKind::rate, .node = "r1"};
  rate.rate = {.between_s = 1, .repair_s = repair_s};
  WorldPlan plan = plan_of(2, 1, {rate});
  plan.task.mean_s = run_s;
  World world(plan);
  std::size_t count = 0;
  world.nodes().at("r1")->robot()->on_fail = [&] { ++count; };
  check_unbroken(world.play());
  return count;
}

}  // namespace

TEST_CASE("fault: a robot breaks by chance for as long as the run is played, and once if nobody repairs it") {
  CHECK(failures_in(2000, 0.1) > 1600);
  CHECK(failures_in(60, std::nullopt) == 1);
}

TEST_CASE("fault: what happens late happens all the same: the world is played as much longer") {
  const double usual_s = plan_of(1, 1).limit_s();
  WorldPlan plan = plan_of(1, 1, {{7000, FaultKind::heal, "r0"}, {5000, FaultKind::cut, "r0"}});
  CHECK(plan.limit_s() == usual_s + 7000);
  Fault rate{.kind = FaultKind::rate, .node = "r0"};
  rate.rate = {.between_s = 1, .repair_s = 9000};
  plan.faults.push_back(rate);
  CHECK(plan.limit_s() == usual_s + 9000);
  plan.sensors.push_back({"cloud", {}, 1, Course({{0, 1.0}, {10'000, 2.0}})});
  CHECK(plan.limit_s() == usual_s + 10'000);
  plan.faults.push_back({kMaxUntil, FaultKind::fail, "r0"});
  CHECK(plan.limit_s() == kMaxUntil);
  plan.until_s = 100;  // from the submission, some seconds behind the links, which are waited for a minute at most
  CHECK(plan.limit_s() == 165);
}

TEST_CASE("fault: a run whose link is cut before the usual end and healed behind it goes on then") {
  World world(plan_of(2, 2, {{1, FaultKind::cut, "r0"}, {5000, FaultKind::heal, "r0"}}));
  const Played is = world.play();
  check_all_done(is, 2);
  CHECK(is.makespan_s > 4000);
}

TEST_CASE("fault: a robot that is repaired while its node is off tells it when the node is back") {
  World world(plan_of(3, 6,
                      {{1, FaultKind::fail, "r1"},
                       {2, FaultKind::kill, "r1"},
                       {3, FaultKind::repair, "r1"},
                       {4, FaultKind::start, "r1"}}));
  check_finished(world.play(), 6);
  CHECK(world.nodes().at("r1")->disk().out_of_use.empty());
}
