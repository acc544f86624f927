// What goes wrong: robots that break, links that are cut, nodes that die; and cores that are broken on purpose, which
// the invariants must catch.
#include <algorithm>
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
  check_all_done(is, 6);
}

TEST_CASE("a link is cut while a baton should pass: the run waits, and ends once it is healed") {
  World world(plan_of(2, 4, {{2, FaultKind::cut, "r0", "r1"}, {40, FaultKind::heal, "r0", "r1"}}));
  const Played is = world.play();
  check_finished(is, 4);
}

TEST_CASE("a node dies and comes back: what is on its disk is all that it knows, and it is enough") {
  World world(plan_of(3, 6, {{1.5, FaultKind::kill, "r1", ""}, {9, FaultKind::start, "r1", ""}}));
  const Played is = world.play();
  check_finished(is, 6);
}

TEST_CASE("a robot breaks and its node is away until the run has ended without it: it asks, and is told") {
  World world(plan_of(2, 4, {{7, FaultKind::fail, "r0"}, {7.5, FaultKind::kill, "r0"}, {40, FaultKind::start, "r0"}}));
  const Played is = world.play();
  check_unbroken(is);
  CHECK(is.state == RunState::finished);
  CHECK(is.over_everywhere);
}

namespace {

/// What may go wrong in a short run, drawn by the seed.
class BadDay {
 public:
  explicit BadDay(std::uint64_t seed) : dice_(seed ^ 0xBAD) {
    // One draw a statement: of a call's arguments each compiler has its own order.
    const auto tasks = static_cast<std::uint32_t>(2 + dice_.below(4));
    const auto robots = static_cast<std::uint32_t>(2 + dice_.below(2));
    plan_ = plan_of(robots, tasks, {}, seed);
    plan_.link = kLinkKinds[dice_.below(kLinkKinds.size())];
    plan_.task.mean_s = 1;
    plan_.until_s = 400;
    if (dice_.below(2) == 0) plan_.relays = {"cloud"};
    for (std::uint64_t i = dice_.below(3); i > 0; --i) go_wrong();
    if (dice_.below(3) == 0) go_on_beside();
  }
  [[nodiscard]] const WorldPlan& plan() const { return plan_; }

 private:
  std::string robot() { return "r" + std::to_string(dice_.below(plan_.robots)); }
  double time() { return 0.001 * static_cast<double>(dice_.below(8000)); }
  std::string node() { return dice_.below(4) == 0 ? "cloud" : robot(); }
  void add(Fault fault) { plan_.faults.push_back(std::move(fault)); }

  /// The same tasks once more, with the same robots.
  void go_on_beside() {
    plan_.fleet = paper_robots(plan_.robots);
    plan_.scenario = in_turn(plan_.tasks, plan_.fleet);
    plan_.beside.push_back({.scenario = plan_.scenario, .after_s = time()});
  }

  void go_wrong() {
    switch (dice_.below(8)) {
      case 0:
      case 1:
        return die();
      case 2:
        return be_cut(Way::both);
      case 3:
        return be_cut(dice_.below(2) == 0 ? Way::there : Way::back);
      case 4:
        return fall_apart();
      case 5:
        return be_slow();
      case 6:
        return be_late();
      default:
        return wear_out();
    }
  }
  void die() {
    const double at = time();
    const std::string who = node();
    add({at, FaultKind::kill, who});
    add({at + 0.1 + time(), FaultKind::start, who});
  }
  void be_cut(Way way) {
    Fault cut{time(), FaultKind::cut, robot()};
    cut.way = way;
    add(cut);
    add({cut.at_s + time(), FaultKind::heal, cut.node});
  }
  void fall_apart() {
    Fault apart{.at_s = time(), .kind = FaultKind::partition, .nodes = {"r0", dice_.below(2) == 0 ? "cloud" : "r1"}};
    add(apart);
    apart.kind = FaultKind::heal;
    apart.at_s += time();
    add(apart);
  }
  void be_slow() {
    add({.kind = FaultKind::disk,
         .node = node(),
         .from_start = true,
         .commit_s = 0.1 * static_cast<double>(dice_.below(5))});
  }
  void be_late() {
    const ClockFault clocks[] = {
        {.ahead_s = 20 * static_cast<double>(dice_.below(20)) - 200}, {.drift_ppm = 500}, {.is_1970 = true}};
    add({.at_s = time(),
         .kind = FaultKind::clock,
         .node = node(),
         .from_start = dice_.below(2) == 0,
         .clock = clocks[dice_.below(3)]});
  }
  /// One robot alone: with two of two broken nobody is left.
  void wear_out() {
    const bool by_chance = dice_.below(3) == 0;
    const bool is_first = std::ranges::none_of(plan_.faults, [](const Fault& one) {
      return one.kind == FaultKind::fail || one.kind == FaultKind::battery || one.kind == FaultKind::rate;
    });
    if (!is_first) return;
    if (by_chance) return add({.kind = FaultKind::rate, .node = "r0", .rate = {.between_s = 10, .repair_s = 3}});
    if (dice_.below(2) == 0) return add({time(), FaultKind::fail, "r0"});
    add({.kind = FaultKind::battery, .node = "r0", .from_start = true, .battery = {.percent = 12, .per_second = 10}});
  }

  Dice dice_;
  WorldPlan plan_;
};

}  // namespace

// TRB_SEEDS=N how many (20); TRB_FIRST=N from which on.
TEST_CASE("whatever goes wrong, no task is done twice or said to be done in vain") {
  const std::uint64_t first = from_environment("TRB_FIRST", 1), seeds = from_environment("TRB_SEEDS", 20);
  std::uint64_t finished = 0, events = 0;
  for (std::uint64_t seed = first; seed < first + seeds; ++seed) {
    CAPTURE(seed);
    World world(BadDay(seed).plan());
    const Played is = world.play();
    check_unbroken(is);
    for (const PlayedRun& run : is.beside) check_unbroken(run);
    finished += is.state == RunState::finished ? 1U : 0U;
    events += is.events;
  }
  MESSAGE(seeds << " runs, " << finished << " of them FINISHED, " << events << " events");
  CHECK(finished * 2 > seeds);
}

TEST_CASE("a run of which a task was begun and none done has no makespan yet") {
  const Played is = World(plan_of(1, 1, {{1, FaultKind::fail, "r0"}})).play();
  CHECK(is.tasks_done == 0);
  CHECK(is.makespan_s == 0);
}

TEST_CASE("a node with a slow disk dies before it has written what its robot has done: nobody can know it") {
  for (int i = 0; i < 30; ++i) {
    CAPTURE(i);
    const double at_s = 3 + 0.05 * i;
    WorldPlan plan = plan_of(3, 3, {{at_s, FaultKind::kill, "r2"}, {at_s + 2, FaultKind::start, "r2"}});
    plan.faults.push_back({.kind = FaultKind::disk, .node = "r2", .from_start = true, .commit_s = 0.4});
    plan.task.mean_s = 1;
    plan.until_s = 400;
    check_unbroken(World(plan).play());
  }
}
