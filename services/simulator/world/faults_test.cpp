// What goes wrong: robots that break, links that are cut, nodes that die; and cores that are broken on purpose, which
// the invariants must catch.
#include <cstdlib>

#include "services/scheduler/core/journal_records.hpp"
#include "services/simulator/world/test/plans.hpp"

using namespace trb;
using namespace trb::world;
using namespace trb::world::test;

namespace {

std::uint64_t from_environment(const char* name, std::uint64_t otherwise) {
  const char* text = std::getenv(name);
  return text == nullptr ? otherwise : std::strtoull(text, nullptr, 10);
}

}  // namespace

TEST_CASE("a robot breaks: the cloud gives its tasks to another one, and all of them are done") {
  World world(plan_of(3, 6, {{4, FaultKind::fail, "r1", ""}}));
  const Played is = world.play();
  check_unbroken(is);
  CHECK(is.state == RunState::finished);
  CHECK(is.over_everywhere);
  CHECK(is.tasks_done == 6);
}

TEST_CASE("a link is cut while a baton should pass: the run waits, and ends once it is healed") {
  World world(plan_of(2, 4, {{2, FaultKind::cut, "r0", "r1"}, {40, FaultKind::heal, "r0", "r1"}}));
  const Played is = world.play();
  check_unbroken(is);
  CHECK(is.state == RunState::finished);
  CHECK(is.tasks_done == 4);
}

TEST_CASE("a node dies and comes back: what is on its disk is all that it knows, and it is enough") {
  World world(plan_of(3, 6, {{1.5, FaultKind::kill, "r1", ""}, {9, FaultKind::start, "r1", ""}}));
  const Played is = world.play();
  check_unbroken(is);
  CHECK(is.state == RunState::finished);
  CHECK(is.tasks_done == 6);
}

namespace {

/// A short run in which something goes wrong, drawn by the seed.
WorldPlan bad_day(std::uint64_t seed) {
  Dice dice(seed ^ 0xBAD);
  WorldPlan plan =
      plan_of(static_cast<std::uint32_t>(2 + dice.below(2)), static_cast<std::uint32_t>(2 + dice.below(4)), {}, seed);
  plan.link = kLinkKinds[dice.below(kLinkKinds.size())];
  plan.task.mean_s = 1;
  plan.until_s = 400;
  const auto robot = [&] { return "r" + std::to_string(dice.below(plan.robots)); };
  const auto time = [&] { return 0.001 * static_cast<double>(dice.below(8000)); };
  for (std::uint64_t i = dice.below(3); i > 0; --i) {
    const double at = time();
    switch (dice.below(3)) {
      case 0: {
        const std::string node = dice.below(4) == 0 ? "cloud" : robot();
        plan.faults.push_back({at, FaultKind::kill, node, ""});
        plan.faults.push_back({at + 0.1 + time(), FaultKind::start, node, ""});
        break;
      }
      case 1: {
        const std::string node = robot();
        plan.faults.push_back({at, FaultKind::cut, node, ""});
        plan.faults.push_back({at + time(), FaultKind::heal, node, ""});
        break;
      }
      default:
        if (plan.faults.empty()) plan.faults.push_back({at, FaultKind::fail, "r0", ""});
    }
  }
  return plan;
}

}  // namespace

// TRB_SEEDS=N how many (20); TRB_FIRST=N from which on.
TEST_CASE("whatever goes wrong, no task is done twice or said to be done in vain") {
  const std::uint64_t first = from_environment("TRB_FIRST", 1), seeds = from_environment("TRB_SEEDS", 20);
  std::uint64_t finished = 0, events = 0;
  for (std::uint64_t seed = first; seed < first + seeds; ++seed) {
    CAPTURE(seed);
    World world(bad_day(seed));
    const Played is = world.play();
    check_unbroken(is);
    finished += is.state == RunState::finished ? 1U : 0U;
    events += is.events;
  }
  MESSAGE(seeds << " runs, " << finished << " of them FINISHED, " << events << " events");
  CHECK(finished * 2 > seeds);
}
