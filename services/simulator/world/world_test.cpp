#include "services/simulator/world/test/plans.hpp"

using namespace trb;
using namespace trb::world;
using namespace trb::world::test;

TEST_CASE("three robots do six tasks in turn: each once, and the run ends everywhere") {
  World world(plan_of(3, 6));
  const Played is = world.play();
  check_all_done(is, 6);
  CHECK(is.accepted);
  CHECK(is.makespan_s > 18);
  CHECK(is.makespan_s < 19);
}

TEST_CASE("one seed gives the same run to the byte, another one another") {
  const auto digest_of = [](std::uint64_t seed) {
    WorldPlan plan = plan_of(3, 4, {}, seed);
    plan.link = *find_link_kind("wifi");
    World world(plan);
    world.play();
    return world.meter().digest();
  };
  CHECK(digest_of(7) == digest_of(7));
  CHECK(digest_of(7) != digest_of(8));
}

TEST_CASE("what is relayed is locked with a nonce that follows from the seed, too") {
  const auto digest_of = [](std::uint64_t seed) {
    WorldPlan plan;
    plan.robots = 3;
    plan.tasks = 3;
    plan.seed = seed;
    plan.relays = {"cloud"};
    plan.faults = {Fault{.kind = FaultKind::cut, .node = "r0", .other = "r1", .from_start = true}};
    World world(plan);
    world.play();
    return world.meter().digest();
  };
  CHECK(digest_of(7) == digest_of(7));
  CHECK(digest_of(7) != digest_of(8));
}

TEST_CASE("a task takes as long as the plan says: its time-out is longer") {
  WorldPlan plan = plan_of(2, 2);
  plan.task.mean_s = 700;
  World world(plan);
  const Played is = world.play();
  check_finished(is, 2);
  CHECK(is.makespan_s > 1400);
  CHECK(world.witness().begun().size() == 2);
}

TEST_CASE("a run lives as long as it is played: a day, or longer") {
  const auto life_s = [](double until_s) {
    WorldPlan plan = plan_of(1, 1);
    plan.until_s = until_s;
    World world(plan);
    check_unbroken(world.play());
    const auto record = world.nodes().at("cloud")->disk().archive.record(world.run());
    REQUIRE(record);
    return to_seconds(Duration{record->view.expires - record->view.created});
  };
  CHECK(life_s(0) == 24 * 3600);
  CHECK(life_s(kMaxUntil) == kMaxUntil);
}

namespace {

const std::map<std::string, Alert>& alerts_of(const World& world) {
  return world.nodes().at("cloud")->disk().alerts.alerts();
}

}  // namespace

TEST_CASE("tasks that run for a minute are no alert: their robots have begun them") {
  WorldPlan plan = plan_of(2, 4);
  plan.task.mean_s = 60;
  World world(plan);
  check_all_done(world.play(), 4);
  CHECK(alerts_of(world).empty());
}

TEST_CASE("a task that was begun in time is not skipped because its robot is gone, whatever the scenario allows") {
  WorldPlan plan = plan_of(2, 2, {{20, FaultKind::cut, "r0", ""}, {60, FaultKind::heal, "r0", ""}});
  plan.task.mean_s = 40;
  plan.fleet = paper_robots(2);
  plan.scenario = in_turn(2, plan.fleet);
  plan.scenario.tasks[0].on_failure = OnFailure::continue_;
  plan.scenario.tasks[0].start_within_s = 5;
  World world(plan);
  check_all_done(world.play(), 2);
  for (const auto& [id, alert] : alerts_of(world)) CHECK(alert.verdict == Verdict::none);
}

TEST_CASE("a run that is under way when its time is up was cut off: nothing is broken") {
  WorldPlan plan = plan_of(2, 4);
  plan.until_s = 8;
  const Played is = World(plan).play();
  check_unbroken(is);
  CHECK(is.cut_off);
  CHECK_FALSE(is.over_everywhere);
  CHECK_FALSE(World(plan_of(2, 4)).play().cut_off);
}

TEST_CASE("how long is played counts from the run's submission, as faults' times do") {
  WorldPlan plan = plan_of(2, 4);  // twelve seconds, and a minute behind its end
  plan.until_s = 75;
  check_all_done(World(plan).play(), 4);
  plan.until_s = 8;
  const Played is = World(plan).play();
  CHECK(is.seconds - is.submitted_s == doctest::Approx(8));
  REQUIRE(is.standstill);
  CHECK_FALSE(is.standstill->is_finished);
}

TEST_CASE("of a run whose tasks are all done, and which the nodes keep for a minute more, the cloud knows the end") {
  WorldPlan plan = plan_of(2, 4);
  plan.until_s = 12.5;
  const Played is = World(plan).play();
  check_finished(is, 4);
  CHECK(is.cut_off);
  CHECK_FALSE(is.over_everywhere);
  REQUIRE(is.standstill);
  CHECK(is.standstill->is_finished);
}

TEST_CASE(
    "a run has its end when the cloud has it: some milliseconds behind its last task, a minute before the nodes") {
  WorldPlan plan = plan_of(3, 4);
  double done_s = 0;
  World whole(plan);
  whole.on_second = [&](const World& world) {
    if (world.tasks_done() == 4 && done_s == 0) done_s = world.moved_s() - world.runs().front().outcome.submitted_s;
  };
  CHECK(whole.play().state == RunState::finished);
  const auto end_within = [&](double seconds) {
    plan.until_s = done_s + seconds;
    return World(plan).play();
  };
  CHECK_FALSE(end_within(-0.001).state);
  const Played just = end_within(0.001);  // the robot has done it, and nobody has heard of it
  CHECK(just.tasks_done == 4);
  CHECK_FALSE(just.state);
  CHECK(end_within(0.1).state == RunState::finished);
  CHECK_FALSE(end_within(59).over_everywhere);
  CHECK(end_within(61).over_everywhere);
}

TEST_CASE("links that are not up are told: the run is submitted all the same, and played as long as was asked for") {
  WorldPlan plan = plan_of(2, 2);
  CHECK(World(plan).play().all_linked);
  plan.faults = {Fault{.kind = FaultKind::cut, .node = "r0", .from_start = true}};
  plan.until_s = 10;
  const Played is = World(plan).play();
  CHECK_FALSE(is.all_linked);
  CHECK(is.linked_s >= 60);
  CHECK(is.submitted_s > is.linked_s);
  CHECK(is.seconds - is.submitted_s == doctest::Approx(10));
}

TEST_CASE("faults whose time does not come before the end are told; one that comes and one by chance are not") {
  Fault rate{.kind = FaultKind::rate, .node = "r1"};
  rate.rate.between_s = 1e7;
  const Played is = World(plan_of(2, 2,
                                  {{2, FaultKind::cut, "r0", "r1"},
                                   {1e5, FaultKind::fail, "r0"},
                                   {2.5, FaultKind::heal, "r0", "r1"},
                                   rate,
                                   {.kind = FaultKind::disk, .node = "r1", .from_start = true}}))
                        .play();
  check_all_done(is, 2);
  REQUIRE(is.not_reached.size() == 1);
  CHECK(is.not_reached[0].index == 1);
  CHECK(is.not_reached[0].at_s == 1e5);
}

TEST_CASE("a run that stands still until its time is up is broken, unless somebody wanted no more of it") {
  Meddler deaf;  // the cloud hears of no result
  deaf.sends = [](const std::string&, const Send& send) { return !holds_alternative<Results>(send.body); };
  WorldPlan plan = plan_of(2, 4, {{2, FaultKind::disk, "r0"}});  // what is sent again is no matter then
  plan.until_s = 300;
  const Played stuck = World(plan, deaf).play();
  CHECK(stuck.cut_off);
  CHECK_FALSE(stuck.broken.empty());
  plan.must_end = false;
  check_unbroken(World(plan, deaf).play());
}

TEST_CASE("who watches a world may stop it") {
  World world(plan_of(2, 4));
  world.meter().trace = [&](const Sending& sending, CostPhase) {
    if (sending.subtype == Execute::kSubtype) world.stop();
  };
  const Played is = world.play();
  CHECK(is.cut_short);
  CHECK_FALSE(is.cut_off);
  CHECK(is.tasks_done == 0);
}
