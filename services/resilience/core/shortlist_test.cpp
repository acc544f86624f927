#include "services/resilience/core/shortlist.hpp"

#include <doctest/doctest.h>

using namespace trb;
using namespace trb::resilience;

namespace {

struct Robots {
  FleetIndex index;
  std::vector<RobotNumber> numbers;
  Robots(std::initializer_list<Measures> all) {
    for (const Measures& one : all) {
      const RobotNumber number = *index.add("r" + std::to_string(numbers.size()));
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

}  // namespace

TEST_CASE("the best by each measure, and by all of them together") {
  const Robots robots{{90, 8, 0, 50}, {50, 1, 0, 100}, {80, 2, 0, 100}};
  CHECK(robots.best({1, 0, 0}, 3) == Numbers{0, 2, 1});
  CHECK(robots.best({0, 1, 0}, 3) == Numbers{1, 2, 0});
  CHECK(robots.best({0, 0, 1}, 3) == Numbers{1, 2, 0});
  const auto all = shortlist(robots.index, robots.numbers, {1, 1, 1}, {0, 0}, 1);
  REQUIRE(all.size() == 1);
  CHECK(all[0].robot == 1);
  CHECK(all[0].score == doctest::Approx(0.5 + 1 + 1));
}

TEST_CASE("what nobody knows counts nothing, and nobody is divided by no distance") {
  const Robots robots{{kUnknown, kUnknown, kUnknown, 100}, {10, 0, 0, 100}, {10, 0, 0, 100}};
  CHECK(robots.best({1, 1, 0}, 2) == Numbers{1, 2});
  CHECK(robots.best({1, 1, 1}, 9) == Numbers{1, 2, 0});
  CHECK(robots.best({1, 1, 1}, 0).empty());
  CHECK(Robots{}.best({1, 1, 1}, 3).empty());
}
