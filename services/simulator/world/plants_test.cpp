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

namespace {

/// r1 keeps none of these on its disk.
Meddler keeps_not(bool epochs, bool given_back) {
  Meddler plant;
  plant.writes = [=](const std::string& node, const Journal& record) {
    const auto* result = std::any_cast<scheduler::JournalResult>(&record.record);
    const bool is_epoch = std::any_cast<scheduler::JournalDecision>(&record.record) != nullptr;
    return node != "r1" || !((epochs && is_epoch) || (given_back && result != nullptr));
  };
  return plant;
}

}  // namespace

// Two guards keep r1 from t4: the new epoch, and its own signed word that it gave t4 back. Each alone is enough.
TEST_CASE("plant: a scheduler for which no new epoch counts does what was given to another") {
  // r1 breaks in t1, so that t1 and t4 are given to others; it is repaired and starts anew.
  WorldPlan plan = plan_of(3, 6,
                           {{1, FaultKind::fail, "r1"},
                            {6.5, FaultKind::repair, "r1"},
                            {6.6, FaultKind::kill, "r1"},
                            {6.9, FaultKind::start, "r1"}});
  plan.fleet = paper_robots(plan.robots);
  plan.scenario = in_turn(plan.tasks, plan.fleet);
  for (Task& task : plan.scenario.tasks) task.after.clear();
  check_unbroken(World(plan, keeps_not(true, false)).play());
  check_unbroken(World(plan, keeps_not(false, true)).play());
  CHECK(caught(plan, keeps_not(true, true)) == "t4: two robots were at it at once");
}

// Both runs have a t0: what is broken of the second one is told of that one alone.
TEST_CASE("plant: a scheduler that writes no start of a second run, and dies at once, begins its task again") {
  WorldPlan plan = plan_of(2, 2, {{10, FaultKind::kill, "r0", ""}, {11, FaultKind::start, "r0", ""}});
  plan.fleet = paper_robots(plan.robots);
  plan.scenario = in_turn(plan.tasks, plan.fleet);
  plan.beside.push_back({.scenario = plan.scenario, .after_s = 9});
  check_unbroken(World(plan).play().beside.at(0));
  Meddler plant;
  plant.writes = [](const std::string&, const Journal& record) {
    return std::any_cast<scheduler::JournalStart>(&record.record) == nullptr;
  };
  const Played is = World(plan, plant).play();
  // The robot itself is of no single run.
  CHECK(is.broken == std::vector<std::string>{"r0 was told to do two things at once"});
  REQUIRE_FALSE(is.beside.at(0).broken.empty());
  CHECK(is.beside[0].broken.front() == "t0: attempt 1 was begun twice");
}
