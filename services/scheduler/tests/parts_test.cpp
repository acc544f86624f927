// The parts of the core that have laws of their own.
#include <doctest/doctest.h>

#include <algorithm>

#include "proto/body.hpp"
#include "services/scheduler/core/duties.hpp"
#include "services/scheduler/core/results.hpp"

using namespace trb;
using namespace trb::scheduler;

namespace {

HeldResult held(std::uint32_t attempt, TaskOutcome outcome, const std::string& data = "") {
  TaskResult result;
  result.key = {"run", "task", 1, attempt};
  result.outcome = outcome;
  result.data = data;
  return {{"result", "ur3", {encode(result)}, {"signature"}}, result};
}

/// A different set for every seed, with many results of few tasks.
ResultSet set_of(std::uint64_t seed) {
  ResultSet out;
  for (int i = 0; i < 30; ++i) {
    seed = seed * 6364136223846793005U + 1442695040888963407U;
    const auto draw = static_cast<std::uint32_t>(seed >> 40U);
    const auto outcome = static_cast<TaskOutcome>(1 + draw % 5);
    out.add(static_cast<TaskIndex>(draw % 3), held(1 + draw / 16 % 6, outcome, std::to_string(draw / 128 % 3)));
  }
  return out;
}

ResultSet joined(ResultSet a, const ResultSet& b) {
  a.join(b);
  return a;
}

}  // namespace

TEST_CASE("joining result sets is idempotent, commutative and associative, also where the bound bites") {
  for (std::uint64_t seed = 1; seed <= 50; ++seed) {
    const ResultSet a = set_of(seed);
    const ResultSet b = set_of(seed + 100);
    const ResultSet c = set_of(seed + 200);
    CHECK(joined(a, a) == a);
    CHECK(joined(a, b) == joined(b, a));
    CHECK(joined(joined(a, b), c) == joined(a, joined(b, c)));
    CHECK(joined(joined(a, b), b) == joined(a, b));
  }
}

TEST_CASE("the first final result counts, else the latest attempt's") {
  ResultSet set;
  CHECK(set.of(0) == nullptr);
  CHECK(set.add(0, held(2, TaskOutcome::failed)));
  CHECK(set.add(0, held(1, TaskOutcome::retriable)));
  CHECK_FALSE(set.add(0, held(1, TaskOutcome::retriable)));
  CHECK(set.of(0)->result.outcome == TaskOutcome::failed);
  CHECK_FALSE(set.has_final(0));
  CHECK(set.add(0, held(1, TaskOutcome::finished)));
  CHECK(set.has_final(0));
  CHECK_FALSE(set.finished_twice(0));
  CHECK(set.add(0, held(1, TaskOutcome::finished, "other")));
  CHECK(set.finished_twice(0));
  CHECK(set.final_tasks(2) == std::vector<bool>{true, false});
}

TEST_CASE("an endless signer fills nothing") {
  ResultSet set;
  for (std::uint32_t i = 1; i <= 100; ++i) set.add(0, held(i, TaskOutcome::failed));
  CHECK(set.of(0)->result.key.attempt == ResultSet::kMaxPerTask);
  CHECK_FALSE(set.add(0, held(100, TaskOutcome::finished)));
}

TEST_CASE("a duty is sent at once, then after 0.2 s, doubled up to 2 s, until it is settled") {
  Duties duties;
  duties.owe(DutyKind::baton, "ur3", {1, 2});
  duties.owe(DutyKind::baton, "ur3", {1, 2});
  MonotonicTime now{0};
  std::vector<double> times;
  while (now <= MonotonicTime{0} + seconds(6)) {
    CHECK(duties.take_due(now).size() == 1);
    times.push_back(to_seconds(now - MonotonicTime{0}));
    CHECK(duties.take_due(now).empty());
    now = *duties.next();
  }
  const std::vector<double> expected{0, 0.2, 0.6, 1.4, 3.0, 5.0};
  REQUIRE(times.size() == expected.size());
  for (std::size_t i = 0; i < times.size(); ++i) CHECK(times[i] == doctest::Approx(expected[i]));
  CHECK_FALSE(duties.settle(DutyKind::baton, "ur3", {1}));
  CHECK_FALSE(duties.settle(DutyKind::baton, "drone", {1, 2}));
  CHECK(duties.settle(DutyKind::baton, "ur3", {1, 2}));
  CHECK_FALSE(duties.settle(DutyKind::baton, "ur3", {1, 2}));
  CHECK(duties.empty());
}

TEST_CASE("results for a node that is away go together, those for one that answers go alone") {
  Duties duties;
  duties.owe(DutyKind::results, "cloud", {0});
  MonotonicTime now{0};
  CHECK(duties.take_due(now).size() == 1);
  duties.owe(DutyKind::results, "cloud", {1});
  CHECK(duties.take_due(now)[0].tasks == std::vector<TaskIndex>{1});
  for (int i = 0; i < 8; ++i) {
    now = *duties.next();
    duties.take_due(now);
  }
  now = *duties.next();
  CHECK(duties.take_due(now)[0].tasks == std::vector<TaskIndex>{0, 1});
  CHECK(duties.settle(DutyKind::results, "cloud", {1, 5}));
  CHECK(duties.creditors(DutyKind::results) == std::vector<std::string>{"cloud"});
}
