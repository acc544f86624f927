// Several runs at once on one fleet.
#include "services/simulator/world/test/plans.hpp"

using namespace trb;
using namespace trb::world;
using namespace trb::world::test;

namespace {

/// So many robots do so many tasks in turn, in each of two runs.
WorldPlan two_runs(std::uint32_t robots, std::uint32_t tasks, std::vector<Fault> faults = {}) {
  WorldPlan plan = plan_of(robots, tasks, std::move(faults));
  plan.fleet = paper_robots(robots);
  plan.scenario = in_turn(tasks, plan.fleet);
  plan.beside.push_back({.scenario = plan.scenario});
  return plan;
}

/// Each run's tasks are done, once each, and every node knows it.
void check_both_done(const World& world, const Played& is, std::size_t tasks) {
  check_all_done(is, tasks);
  REQUIRE(is.beside.size() == 1);
  check_run_done(is.beside[0], tasks);
  for (const WorldRun& run : world.runs()) {
    for (std::size_t i = 0; i < tasks; ++i) CHECK(run.witness.done("t" + std::to_string(i)) == 1);
  }
}

}  // namespace

TEST_CASE("two runs at once on the same robots: every task of each is done once, and both end everywhere") {
  World world(two_runs(3, 6));
  const Played is = world.play();
  check_both_done(world, is, 6);
  CHECK(is.beside[0].accepted);
  CHECK(world.runs()[0].id != world.runs()[1].id);
  CHECK(world.tasks_done() == 12);
}

TEST_CASE("what two runs cost each other: the one robot does the tasks of both in turn") {
  World world(two_runs(1, 3));
  const Played is = world.play();
  check_both_done(world, is, 3);
  // Nine seconds each if alone; one robot does 18 s of work, and each run has its last task at the end.
  CHECK(is.makespan_s > 14.9);
  CHECK(is.beside[0].makespan_s > 14.9);
  CHECK(std::max(is.makespan_s, is.beside[0].makespan_s) < 19);
}

TEST_CASE("a run that is submitted later begins later, and what goes wrong counts from the first one's submission") {
  WorldPlan plan = two_runs(2, 4, {{12.5, FaultKind::fail, "r1"}, {20, FaultKind::repair, "r1"}});
  plan.beside[0].after_s = 13;
  World world(plan);
  double failed_s = 0;
  world.on_fault = [&](const Fault& fault) {
    if (fault.kind == FaultKind::fail) failed_s = world.seconds_passed();
  };
  const Played is = world.play();
  check_both_done(world, is, 4);
  CHECK(is.beside[0].submitted_s - is.submitted_s == doctest::Approx(13));
  CHECK(failed_s - is.submitted_s == doctest::Approx(12.5));
}

TEST_CASE("a robot breaks that two runs use: each gives its tasks to another one") {
  World world(two_runs(3, 6, {{4, FaultKind::fail, "r1"}}));
  check_both_done(world, world.play(), 6);
}

TEST_CASE("a node dies while it has tasks of two runs, and knows both once it is back") {
  World world(two_runs(3, 6, {{1.5, FaultKind::kill, "r1"}, {9, FaultKind::start, "r1"}}));
  check_both_done(world, world.play(), 6);
}

TEST_CASE("the fleet comes up as with one run: nothing is drawn otherwise until a second one is submitted") {
  const auto first_messages = [](bool has_two) {
    WorldPlan plan = two_runs(3, 4);
    if (!has_two) plan.beside.clear();
    World world(plan);
    std::uint64_t digest = 0;
    world.meter().trace = [&](const Sending& sending, CostPhase) {
      if (sending.subtype == RunSubmit::kSubtype) world.stop();
      digest = world.meter().digest();
    };
    world.play();
    return digest;
  };
  CHECK(first_messages(true) == first_messages(false));
}

TEST_CASE("one seed gives the same two runs to the byte") {
  const auto digest_of = [](std::uint64_t seed) {
    WorldPlan plan = two_runs(3, 4);
    plan.seed = seed;
    plan.link = *find_link_kind("wifi");
    World world(plan);
    world.play();
    return world.meter().digest();
  };
  CHECK(digest_of(7) == digest_of(7));
  CHECK(digest_of(7) != digest_of(8));
}

TEST_CASE("a run that is over is told as such beside one whose time was up while its robot was at work") {
  WorldPlan plan = two_runs(2, 1);
  plan.beside[0].scenario.tasks[0].robot = "r1";
  plan.times["task:t0"].mean_s = 3;
  plan.beside[0].scenario.tasks[0].id = "long";
  plan.times["task:long"].mean_s = 200;
  plan.until_s = 90;
  const Played is = World(plan).play();
  check_all_done(is, 1);
  CHECK_FALSE(is.cut_off);
  const PlayedRun& other = is.beside.at(0);
  CHECK(other.cut_off);
  CHECK(other.broken.empty());
  REQUIRE(other.standstill);
  CHECK(other.standstill->at_work == 1);
  CHECK(other.standstill->still_s == 0);
}

TEST_CASE("a run that waits for a robot that another one keeps does not stand still") {
  WorldPlan plan = two_runs(1, 1);
  plan.times["task:t0"].mean_s = 400;
  plan.fleet = paper_robots(1, 500);
  plan.beside[0].scenario.tasks[0].id = "waits";
  plan.until_s = 300;
  const Played is = World(plan).play();
  check_unbroken(is);
  const PlayedRun& waits = is.beside.at(0);
  CHECK(waits.broken.empty());
  REQUIRE(waits.standstill);
  CHECK(waits.standstill->at_work == 0);
  CHECK(waits.standstill->still_s == 0);
}

TEST_CASE("a run that the cloud refuses is told, and the other one ends all the same") {
  WorldPlan plan = two_runs(2, 2);
  plan.beside[0].scenario.tasks.clear();
  const Played is = World(plan).play();
  check_all_done(is, 2);
  REQUIRE(is.beside.at(0).broken.size() == 1);
  CHECK(is.beside[0].broken[0].starts_with("the run was refused: "));
  CHECK(is.seconds < 120);
}

TEST_CASE("each message of a run is known as that run's, also in short form, and none if there is only one") {
  std::map<std::optional<std::size_t>, std::map<std::string, int>> counts;
  const auto count = [&](WorldPlan plan) {
    counts.clear();
    World world(std::move(plan));
    world.meter().trace = [&](const Sending& sending, CostPhase) {
      ++counts[world.message_run()][std::string(sending.subtype)];
    };
    world.play();
  };
  count(two_runs(3, 6));
  for (const std::size_t run : {std::size_t{0}, std::size_t{1}}) {
    for (const std::string_view subtype :
         {Baton::kSubtype, Definition::kSubtype, Results::kSubtype, Execute::kSubtype}) {
      CAPTURE(subtype);
      CHECK(counts[run][std::string(subtype)] > 0);
      CHECK(counts[std::nullopt][std::string(subtype)] == 0);
    }
  }
  count(plan_of(3, 6));
  CHECK(counts.size() == 1);
}

TEST_CASE("tasks are divided into runs, each with its own robots as long as there are enough") {
  const auto runs = divide(10, paper_robots(4), {.runs = 2, .at_once = false});
  REQUIRE(runs.size() == 2);
  CHECK(runs[0].scenario.name == "in turn, run 1");
  CHECK(runs[0].scenario.tasks.size() == 6);
  CHECK(runs[1].scenario.tasks.size() == 4);
  CHECK(runs[0].scenario.tasks[1].robot == "r1");
  CHECK(runs[1].scenario.tasks[0].robot == "r2");
  CHECK(runs[1].scenario.tasks[1].after == std::vector<std::uint16_t>{0});
  const auto shared = divide(4, paper_robots(1), {.runs = 3, .at_once = true});
  REQUIRE(shared.size() == 3);
  CHECK(shared[0].scenario.tasks.size() == 2);
  CHECK(shared[0].scenario.tasks[1].after.empty());
  CHECK(divide(2, paper_robots(5), {.runs = 5, .at_once = true}).size() == 2);
  const RunSize of_p9 = largest_run(10'000, 1000, {.runs = 10, .at_once = true});
  CHECK(of_p9.tasks == 1000);
  CHECK(of_p9.robots == 100);
}

TEST_CASE("tasks that are divided take as long as one robot needs for its own, not as all of them in turn") {
  WorldPlan plan = plan_of(6, 12);
  plan.division = {.runs = 3, .at_once = true};
  World world(plan);
  const Played is = world.play();
  check_all_done(is, 4);
  REQUIRE(is.beside.size() == 2);
  for (const PlayedRun& run : is.beside) {
    check_run_done(run, 4);
    CHECK(run.makespan_s > 6);
    CHECK(run.makespan_s < 6.5);
  }
}
