#include "services/simulator/world/test/plans.hpp"

using namespace trb;
using namespace trb::world;
using namespace trb::world::test;

TEST_CASE("three robots do six tasks in turn: each once, and the run ends everywhere") {
  World world(plan_of(3, 6));
  const Played is = world.play();
  check_unbroken(is);
  CHECK(is.accepted);
  CHECK(is.state == RunState::finished);
  CHECK(is.over_everywhere);
  CHECK(is.tasks_done == 6);
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
