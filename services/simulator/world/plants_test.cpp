// Cores that are broken on purpose, through their seam: the invariants must catch each one. The same plans hold with
// cores that are whole.
#include "services/scheduler/core/journal_records.hpp"
#include "services/simulator/world/test/plans.hpp"

using namespace trb;
using namespace trb::world;
using namespace trb::world::test;

namespace {

/// The first invariant that does not hold.
std::string caught(const WorldPlan& plan, Meddler plant) {
  check_unbroken(World(plan).play());
  World world(plan, std::move(plant));
  const Played is = world.play();
  for (const std::string& broken : is.broken) MESSAGE(broken);
  return is.broken.empty() ? "" : is.broken.front();
}

}  // namespace

TEST_CASE("plant: a scheduler that acknowledges no baton is sent it again") {
  Meddler plant;
  plant.sends = [](const std::string& node, const Send& send) {
    return node != "r1" || !holds_alternative<BatonJournaled>(send.body);
  };
  CHECK(caught(plan_of(3, 6), plant) == "r0 has sent r1 the same baton again");
}

TEST_CASE("plant: a cloud that acknowledges no result is sent it again") {
  Meddler plant;
  plant.sends = [](const std::string&, const Send& send) { return !holds_alternative<ResultsJournaled>(send.body); };
  CHECK(caught(plan_of(2, 4), plant) == "r0 has sent cloud the same results again");
}

TEST_CASE("plant: a scheduler that writes no result, and dies before anybody else has it, loses what was done") {
  const WorldPlan plan = plan_of(3, 6,
                                 {{4.5, FaultKind::cut, "r1", ""},
                                  {7, FaultKind::kill, "r1", ""},
                                  {8, FaultKind::start, "r1", ""},
                                  {9, FaultKind::heal, "r1", ""}});
  Meddler plant;
  plant.writes = [](const std::string& node, const Journal& record) {
    return node != "r1" || std::any_cast<scheduler::JournalResult>(&record.record) == nullptr;
  };
  CHECK(caught(plan, plant) == "t1 was done, and no node knows it");
}

TEST_CASE("plant: a robot's scheduler that writes no start, and dies at once, begins the task again") {
  const WorldPlan plan = plan_of(2, 4, {{1, FaultKind::kill, "r0", ""}, {2, FaultKind::start, "r0", ""}});
  Meddler plant;
  plant.writes = [](const std::string&, const Journal& record) {
    return std::any_cast<scheduler::JournalStart>(&record.record) == nullptr;
  };
  CHECK(caught(plan, plant) == "t0: attempt 1 was begun twice");
}
