// The model of our own protocol, held against what the real cores send in the world, term by term.
#include <doctest/doctest.h>

#include <cmath>
#include <map>
#include <string>
#include <string_view>

#include "common/model/own_parameters.hpp"
#include "proto/travel.hpp"
#include "services/simulator/world/world.hpp"

using namespace trb;
using namespace trb::world;
using model::OwnParameters;
using model::OwnTerm;

namespace {

constexpr double kWithin = 0.02;  ///< of upkeep, and of what goes by time

/// What went between computers, by subtype; a user's word counts as one of "values".
struct Counts {
  std::map<std::string, std::uint64_t, std::less<>> all, before;  ///< `before` the run was submitted
  double hello_s = 0;                                             ///< the sum of the Hellos' times
  [[nodiscard]] double of(std::string_view subtype) const {
    const auto at = all.find(subtype);
    return at == all.end() ? 0 : static_cast<double>(at->second);
  }
  void add(const Sending& sending, bool submitted) {
    if (!sending.between_computers) return;
    const std::string name(find_travel(sending.subtype) == nullptr ? "values" : sending.subtype);
    ++all[name];
    if (!submitted) ++before[name];
    if (name == Hello::kSubtype) hello_s += sending.at_s;
  }
};

struct Counted {
  Counts counts;
  Played played;
  std::uint64_t connections = 0;
};

Counted count(WorldPlan plan) {
  World world(std::move(plan));
  Counted out;
  bool submitted = false;
  world.meter().trace = [&](const Sending& sending, CostPhase) {
    // What a person submits goes no further than to his own node.
    submitted = submitted || sending.subtype == RunSubmit::kSubtype;
    out.counts.add(sending, submitted);
  };
  out.played = world.play();
  out.connections = world.meter().connections();
  REQUIRE(out.played.over_everywhere);
  REQUIRE(out.played.broken.empty());
  return out;
}

/// What a run's parameters do not say: how the fleet came up, and how long it was.
void add_coming_up(const Counted& counted, OwnParameters& p) {
  const Counts& counts = counted.counts;
  const auto before = [&](const char* subtype) {
    const auto at = counts.before.find(subtype);
    return at == counts.before.end() ? 0 : at->second;
  };
  p.crossed = counted.connections - p.robots * (p.robots + 1) / 2;
  p.told = before("node_profile");
  p.seconds = counted.played.seconds - counts.hello_s / counts.of(Hello::kSubtype);
}

void check_terms(const Counted& counted, const OwnParameters& p) {
  REQUIRE(check(p).ok());
  for (const OwnTerm& term : model::own_terms()) {
    const double wanted = term.value(p), is = counted.counts.of(term.subtype);
    CAPTURE(term.subtype);
    CAPTURE(wanted);
    CAPTURE(is);
    // A clock that strikes once more or less at each node.
    const double least = term.subtype == "beacon" ? static_cast<double>(p.robots + 1) : 0;
    CHECK(std::abs(is - wanted) <= (term.by_time ? std::max(least, kWithin * wanted) : 0));
  }
}

double upkeep_of(const Counted& counted) {
  double out = 0;
  for (const auto& [subtype, messages] : counted.counts.all) {
    out += phase_of(subtype) == CostPhase::upkeep ? static_cast<double>(messages) : 0;
  }
  return out;
}

void check_upkeep(const Counted& counted, const OwnParameters& p) {
  const double wanted = own_messages(CostPhase::upkeep, p), is = upkeep_of(counted);
  CAPTURE(wanted);
  CAPTURE(is);
  CHECK(std::abs(is - wanted) <= kWithin * wanted);
}

void check_nothing_else(const Counted& counted) {
  for (const auto& row : counted.counts.all) {
    CAPTURE(row.first);
    CAPTURE(row.second);
    CHECK(std::ranges::any_of(model::own_terms(), [&](const OwnTerm& term) { return term.subtype == row.first; }));
  }
}

void check_world(const WorldPlan& plan, OwnParameters p) {
  const Counted counted = count(plan);
  add_coming_up(counted, p);
  check_terms(counted, p);
  check_upkeep(counted, p);
  check_nothing_else(counted);
}

/// Four robots, r0 to r3; a letter each: "b" is r1's task.
Scenario graph_of(std::string_view robots, const std::vector<std::vector<std::uint16_t>>& after) {
  Scenario out;
  out.name = "graph";
  for (std::size_t i = 0; i < robots.size(); ++i) {
    Task task;
    task.id = "t" + std::to_string(i);
    task.robot = "r" + std::to_string(robots[i] - 'a');
    task.skill = "work";
    task.after = after[i];
    out.tasks.push_back(std::move(task));
  }
  return out;
}

WorldPlan graph_plan(Scenario scenario) {
  WorldPlan plan;
  plan.fleet = paper_robots(4);
  plan.scenario = std::move(scenario);
  return plan;
}

}  // namespace

TEST_CASE("own model and counts agree term by term: tasks in turn") {
  struct Case {
    std::uint32_t robots, tasks;
    double task_s;
    const char* link;
  };
  for (const Case& one : {Case{1, 4, 3, "lan"}, Case{2, 3, 3, "wifi"}, Case{3, 9, 3, "lan"}, Case{4, 16, 2.7, "lan"},
                          Case{5, 9, 3, "lan"}, Case{6, 6, 4, "lan"}, Case{8, 12, 1.7, "lan"}, Case{5, 5, 15, "lan"},
                          Case{4, 20, 30, "lan"}}) {
    CAPTURE(one.robots);
    CAPTURE(one.tasks);
    WorldPlan plan;
    plan.robots = one.robots;
    plan.tasks = one.tasks;
    plan.task.mean_s = one.task_s;
    plan.seed = one.robots;
    plan.link = *find_link_kind(one.link);
    plan.link.loss = 0;  // what is lost is owed, and sent again
    check_world(plan, model::own_parameters_of(model::tasks_in_turn(one.robots, one.tasks), {}, one.task_s));
  }
}

TEST_CASE("own model and counts agree term by term: graphs") {
  const std::vector<Scenario> graphs{
      graph_of("abcda", {{}, {0}, {0}, {1, 2}, {3}}),               // apart, and together again
      graph_of("aabbccd", {{}, {0}, {}, {2}, {}, {4}, {1, 3, 5}}),  // three blocks beside each other
  };
  for (const Scenario& scenario : graphs) {
    CAPTURE(scenario.tasks.size());
    OwnParameters p = model::own_parameters_of(scenario, {}, 3);
    p.robots = 4;
    check_world(graph_plan(scenario), p);
  }
}

TEST_CASE("own model and counts agree term by term: a robot that breaks") {
  WorldPlan plan;
  plan.robots = 3;
  plan.tasks = 6;
  plan.faults = {{.at_s = 4, .kind = FaultKind::fail, .node = "r1"}};
  OwnParameters p = model::own_parameters_of(model::tasks_in_turn(3, 6), {}, 3);
  p.faulty = 1;
  p.asked = 4;  // of two robots each its charge and its place
  check_world(plan, p);
}
