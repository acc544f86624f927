// A node dies at any commit of its scheduler: what the schedulers' tests tell of a scheduler, told of a whole node.
#include <algorithm>

#include "services/simulator/world/test/plans.hpp"

using namespace trb;
using namespace trb::world;
using namespace trb::world::test;

namespace {

bool asks_a_person(const World& world) {
  const auto& alerts = world.nodes().at("cloud")->disk().alerts.alerts();
  return std::ranges::any_of(alerts, [](const auto& one) { return resilience::is_open(one.second); });
}

/// Two robots do four tasks in turn. Returns how many commits the victim has made.
std::size_t play(const std::string& victim, std::size_t commit, bool after_sends) {
  WorldPlan plan = plan_of(2, 4);
  plan.task.mean_s = 1;
  plan.until_s = 400;
  plan.crashes[victim] = {.at = commit, .after_sends = after_sends};
  World world(plan);
  const Played is = world.play();
  check_unbroken(is);
  const bool all_done = is.state == RunState::finished && is.over_everywhere && is.tasks_done == 4;
  // Whether a robot has done what it was told in that moment, its node does not know afterwards.
  if (victim == "cloud") CHECK(all_done);
  CHECK((all_done || asks_a_person(world)));
  return world.nodes().at(victim)->disk().crash.commits;
}

}  // namespace

TEST_CASE(
    "a node dies at any commit of its scheduler, before or behind what it sends then: all is done, or asked of a "
    "person") {
  constexpr std::size_t kBound = 100;
  for (const std::string victim : {"cloud", "r0", "r1"}) {
    for (const bool after_sends : {false, true}) {
      CAPTURE(victim);
      CAPTURE(after_sends);
      std::size_t commits = 1;
      for (std::size_t at = 1; at <= commits; ++at) {
        CAPTURE(at);
        commits = play(victim, at, after_sends);
        REQUIRE(commits < kBound);
      }
      CHECK(commits > 3);
    }
  }
}

TEST_CASE("a resilience service that starts again knows what has become of its decisions") {
  AlertStore store;
  Decision decision;
  decision.run = "run";
  decision.alert = "alert";
  RunDecision signed_one;
  signed_one.decision.payload.bytes = encode(decision);
  store.write({Journal{signed_one}});
  REQUIRE(store.decisions().size() == 1);
  CHECK_FALSE(store.decisions().begin()->second.delivered);
  store.write({Journal{resilience::DecisionOver{"run", decision.epoch + 1, resilience::DecisionEnd::dropped}},
               Journal{resilience::DecisionOver{"other", decision.epoch, resilience::DecisionEnd::dropped}},
               Journal{resilience::DecisionOver{"run", decision.epoch, resilience::DecisionEnd::handed}}});
  REQUIRE(store.decisions().size() == 1);
  CHECK(store.decisions().begin()->second.delivered);
  store.write({Journal{resilience::DecisionOver{"run", decision.epoch, resilience::DecisionEnd::dropped}}});
  CHECK(store.decisions().empty());
}
