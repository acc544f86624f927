#include "services/resilience/core/shortlist.hpp"

#include <doctest/doctest.h>

#include <cmath>

#include "common/ranking/ranking.hpp"

using namespace trb;
using namespace trb::resilience;

namespace {

struct Robots {
  FleetIndex index;
  std::vector<RobotNumber> numbers;
  explicit Robots(const std::vector<Measures>& all) {
    for (const Measures& one : all) {
      const RobotNumber number = *index.add("r" + std::to_string(1000 + numbers.size()));
      index.set_measures(number, one);
      numbers.push_back(number);
    }
  }
  [[nodiscard]] std::vector<RobotNumber> best(const Weights& weights, std::size_t most) const {
    std::vector<RobotNumber> out;
    for (const Scored& one : shortlist(index, numbers, weights, {0, 0}, most)) out.push_back(one.robot);
    return out;
  }
};

using Numbers = std::vector<RobotNumber>;

std::vector<Measures> many_robots() {
  std::vector<Measures> out;
  for (int i = 0; i < 500; ++i) {
    out.push_back({(i * 37 % 1001) / 10.0, (i * 53 % 997) / 10.0, (i * 71 % 991) / 10.0, 100.0 / (1 + i % 4)});
  }
  return out;
}

}  // namespace

TEST_CASE("the best by each measure, and by all of them together") {
  const Robots robots({{90, 8, 0, 50}, {50, 1, 0, 100}, {80, 2, 0, 100}});
  CHECK(robots.best({1, 0, 0}, 3) == Numbers{0, 2, 1});
  CHECK(robots.best({0, 1, 0}, 3) == Numbers{1, 2, 0});
  CHECK(robots.best({0, 0, 1}, 3) == Numbers{1, 2, 0});
  CHECK(robots.best({0.5, 0.3, 0.2}, 1) == Numbers{2});
}

TEST_CASE("scores and order are those of the AHP itself") {
  const std::vector<Measures> all = many_robots();
  const Robots robots(all);
  Criterion charge{.name = "battery", .weight = 0.5};
  Criterion distance{.name = "distance", .weight = 0.3, .direction = Direction::cost};
  Criterion availability{.name = "availability", .weight = 0.2};
  RankingProblem problem;
  problem.goal = "replace";
  problem.options.top = 10;
  for (std::size_t i = 0; i < all.size(); ++i) {
    problem.alternatives.push_back(robots.index.id_of(robots.numbers[i]));
    charge.values.push_back(all[i].charge);
    distance.values.push_back(kWayStart + std::sqrt(all[i].x * all[i].x + all[i].y * all[i].y));
    availability.values.push_back(all[i].availability);
  }
  problem.criteria = {charge, distance, availability};
  const auto ranked = rank(problem);
  REQUIRE_MESSAGE(ranked.ok(), (ranked ? "" : ranked.error().text()));
  const auto best = shortlist(robots.index, robots.numbers, {0.5, 0.3, 0.2}, {0, 0}, 10);
  REQUIRE(best.size() == ranked->ranking.size());
  for (std::size_t i = 0; i < best.size(); ++i) {
    CHECK(robots.index.id_of(best[i].robot) == ranked->ranking[i].id);
    CHECK(best[i].score == doctest::Approx(ranked->ranking[i].score).epsilon(1e-12));
  }
}

TEST_CASE("what nobody knows counts nothing, and who is there already does not win by that alone") {
  const Robots robots({{kUnknown, kUnknown, kUnknown, 100}, {10, 0, 0, 100}, {10, 0, 0, 100}, {80, 1, 0, 100}});
  CHECK(robots.best({0.5, 0.5, 0}, 3) == Numbers{3, 1, 2});
  CHECK(robots.best({0.4, 0.4, 0.2}, 9) == Numbers{3, 1, 2, 0});
  CHECK(robots.best({1, 1, 1}, 0).empty());
  CHECK(Robots({}).best({1, 1, 1}, 3).empty());
  const Robots nobody_knows({{kUnknown, kUnknown, kUnknown, 50}, {kUnknown, kUnknown, kUnknown, 100}});
  CHECK(nobody_knows.best({0.4, 0.4, 0.2}, 2) == Numbers{1, 0});
}
