#include "services/simulator/counting/play.hpp"

#include <doctest/doctest.h>

#include <cmath>
#include <string>

#include "common/model/paper.hpp"
#include "common/scenario/graph.hpp"
#include "proto/figure3.hpp"
#include "services/simulator/counting/tally.hpp"

using namespace trb;
using namespace trb::counting;

namespace {

/// Deterministic on every machine.
class Dice {
 public:
  explicit Dice(std::uint64_t seed) : state_(seed * 2 + 1) {}
  std::uint32_t below(std::uint32_t bound) {
    state_ = state_ * 6364136223846793005U + 1442695040888963407U;
    return static_cast<std::uint32_t>(state_ >> 33U) % bound;
  }

 private:
  std::uint64_t state_;
};

double duration_of(const Plan& plan) {
  return std::max(plan.seconds, plan.task_s * static_cast<double>(plan.tasks.size()));
}

Tally counted(const Plan& plan) {
  Tally tally(duration_of(plan));
  play(plan, tally);
  return tally;
}

/// The paper's variables of a plan. Blocks by the scenario's own function: the play knows none.
model::PaperParameters parameters_of(const Plan& plan) {
  model::PaperParameters p{.n = plan.robots, .s = plan.device_rates.size(), .delta_t = plan.seconds};
  std::vector<std::string> actors;
  for (const PlannedTask& task : plan.tasks) {
    ++(task.interpreted ? p.N_i : p.N_d);
    p.R_l += task.local_requests;
    p.R_e += task.remote_requests;
    p.N_f += task.taken_over ? 1 : 0;
    actors.push_back(std::to_string(task.robot));
  }
  p.k = blocks_of(actors).k;
  p.sum_m = blocks_of(actors).sum_m;
  for (const double rate : plan.device_rates) p.sum_x += rate;
  return p;
}

/// Any fleet: some robots work in blocks, some in turn; devices at whole numbers of updates.
Plan any_plan(Dice& dice) {
  Plan plan{.robots = 1 + dice.below(40), .tasks = {}, .device_rates = {}};
  plan.seconds = 1 + dice.below(300);
  for (std::uint32_t i = dice.below(6); i > 0; --i) plan.device_rates.push_back(dice.below(5));
  std::uint32_t faults = dice.below(plan.robots);
  for (std::uint32_t i = 1 + dice.below(60); i > 0; --i) {
    PlannedTask task{.robot = dice.below(plan.robots)};
    if (!plan.tasks.empty() && dice.below(2) == 0) task.robot = plan.tasks.back().robot;
    task.interpreted = dice.below(2) == 0;
    if (!plan.device_rates.empty()) task.local_requests = dice.below(3);
    if (!plan.device_rates.empty() && plan.robots > 1) task.remote_requests = dice.below(3);
    if (faults > 0 && dice.below(8) == 0) {
      task.taken_over = true;
      --faults;
    }
    plan.tasks.push_back(task);
  }
  return plan;
}

void check_equal(const Tally& tally, const model::PaperParameters& p) {
  const auto messages = [&](CostPhase phase) { return static_cast<double>(tally.all(phase).messages); };
  CHECK(messages(CostPhase::boot) == model::boot(p));
  CHECK(messages(CostPhase::identification) == model::identification(p));
  CHECK(messages(CostPhase::devices) == model::devices(p));
  CHECK(messages(CostPhase::task) == model::task(p));
  CHECK(messages(CostPhase::forward) == model::forward(p));
  CHECK(messages(CostPhase::sensor) == model::sensor(p));
  CHECK(messages(CostPhase::fail) == model::failures(p));
  CHECK(messages(CostPhase::upkeep) == 0);
  CHECK(static_cast<double>(tally.all().messages) == model::total(p));
}

}  // namespace

TEST_CASE("a thousand fleets at random: what is counted is what the equations say, term by term") {
  for (std::uint64_t seed = 1; seed <= 1000; ++seed) {
    CAPTURE(seed);
    Dice dice(seed);
    const Plan plan = any_plan(dice);
    const model::PaperParameters p = parameters_of(plan);
    REQUIRE_MESSAGE(model::check(p).ok(), (model::check(p).ok() ? "" : model::check(p).error().text()));
    check_equal(counted(plan), p);
  }
}

TEST_CASE("the paper's two bounds, counted") {
  Plan best{.robots = 5, .tasks = std::vector<PlannedTask>(9), .device_rates = {1}, .seconds = 180};
  best.tasks[4].local_requests = 1;
  CHECK(counted(best).all().messages == 251);
  Plan worst{.robots = 5, .tasks = std::vector<PlannedTask>(9), .device_rates = {1}, .seconds = 180};
  for (std::uint32_t i = 0; i < 9; ++i) worst.tasks[i] = {.robot = i % 5, .interpreted = true};
  worst.tasks[4].remote_requests = 1;
  worst.tasks[6].taken_over = true;
  CHECK(counted(worst).all().messages == 299);
}

TEST_CASE("messages come in the order of time, and each is in one interval of the distribution") {
  Dice dice(7);
  const Plan plan = any_plan(dice);
  double last = 0;
  std::uint64_t count = 0;
  play(plan, [&](const CountedMessage& message) {
    CHECK(message.at_s >= last);
    last = message.at_s;
    ++count;
  });
  const Tally tally = counted(plan);
  std::uint64_t sum = 0;
  for (const Count& one : tally.over_time()) sum += one.messages;
  CHECK(sum == count);
  CHECK(tally.all().messages == count);
}

TEST_CASE("the fleet is formed first: then a message now and then") {
  const Plan plan = *cyclic_plan(10, 20, 0);
  const Tally tally = counted(plan);
  REQUIRE(tally.over_time().size() == 61);
  CHECK(tally.over_time()[0].messages == 31 + 55 + 2);  // boot, identification, the first task is told
  CHECK(tally.over_time()[1].messages == 0);
  CHECK(tally.over_time()[3].messages == 2 + 1 + 2);  // done, to the cloud; forward; ready, the next task
}

TEST_CASE("a forward is as long as Figure 3's datagram with the tasks that remain") {
  const Plan plan = *cyclic_plan(3, 5, 1);
  std::string list = "[";
  for (std::size_t i = 1; i < 5; ++i) list += (i == 1 ? "" : ",") + task_json(plan, i);
  list += "]";
  Message datagram;
  datagram.subtype = "baton";
  datagram.source = "r0";
  datagram.target = "r1";
  datagram.data = list;
  const auto bytes = to_figure3(datagram);
  REQUIRE(bytes.ok());
  std::vector<std::uint64_t> forwards;
  play(plan, [&](const CountedMessage& message) {
    if (message.phase == CostPhase::forward) forwards.push_back(message.bytes);
  });
  REQUIRE(forwards.size() == 4);
  CHECK(forwards[0] == bytes->size());
  CHECK(forwards[3] < forwards[0]);
}

TEST_CASE("what stays within a robot's computer and controller is counted apart") {
  const Plan plan = *cyclic_plan(2, 2, 1);
  const Tally tally = counted(plan);
  CHECK(tally.all(CostPhase::task).messages == 8 + 4);
  CHECK(tally.between(CostPhase::task).messages == 2);
  CHECK(tally.between(CostPhase::boot).messages == 2 * 2 + 1);
  CHECK(tally.between(CostPhase::identification).messages == 3);
}

TEST_CASE("a plan that cannot be is refused by its number's name") {
  CHECK(cyclic_plan(0, 1, 0).error().what == "robots: there is none");
  CHECK(cyclic_plan(1, 0, 0).error().what == "tasks: there is none");
  CHECK(cyclic_plan(kMaxPlannedRobots + 1, 1, 0).error().code == Errc::too_large);
  CHECK(cyclic_plan(1, kMaxPlannedTasks + 1, 0).error().code == Errc::too_large);
  CHECK(cyclic_plan(2, 2, 3).error().hint == "use at most 2");
}

TEST_CASE("a task's time that is no sum of halves loses no update: each device sends until the last task's end") {
  Plan plan = *cyclic_plan(1, 10, 0);
  plan.task_s = 0.1;
  plan.device_rates.assign(1000, 1.0);
  const Tally tally = counted(plan);
  CHECK(tally.all(CostPhase::devices).messages == 3000);
  CHECK(play(plan, [](const CountedMessage&) {}) == plan.task_s * 10);
}
