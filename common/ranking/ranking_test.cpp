#include "common/ranking/ranking.hpp"

#include <algorithm>
#include <numeric>

#include "common/ranking/test_ranking.hpp"

using namespace trb;
using namespace trb::ranking_test;

namespace {

/// Who takes over from Ridgeback: the paper's criteria with measured values.
RankingProblem ridgeback() {
  RankingProblem out;
  out.goal = "replace ridgeback";
  out.alternatives = {"pioneer1", "pioneer2", "turtlebot"};
  out.criteria = {{.name = "battery", .unit = "%", .values = {80, 40, 80}},
                  {.name = "distance", .direction = Direction::cost, .unit = "m", .values = {4, 2, 8}},
                  {.name = "availability", .values = {100, 100, 50}}};
  return out;
}

RankingAnswer ranked(const RankingProblem& problem) {
  auto answer = rank(problem);
  REQUIRE_MESSAGE(answer.ok(), (answer.ok() ? "" : answer.error().text()));
  return *answer;
}

double score_of(const RankingAnswer& answer, const std::string& id) {
  for (const RankedAlternative& one : answer.ranking) {
    if (one.id == id) return one.score;
  }
  FAIL("no score of " << id);
  return 0;
}

void check_refused(const RankingProblem& problem, Errc code, const std::string& words) {
  const auto answer = rank(problem);
  REQUIRE_FALSE(answer.ok());
  CHECK(answer.error().code == code);
  CHECK_MESSAGE(answer.error().what.find(words) != std::string::npos, answer.error().what);
  CHECK_FALSE(answer.error().hint.empty());
}

/// A tree of two levels with values at random, the weights given.
RankingProblem any_problem(Dice& dice) {
  RankingProblem out;
  out.goal = "goal";
  const std::size_t count = 1 + dice.below(7);
  for (std::size_t i = 0; i < count; ++i) out.alternatives.push_back("r" + std::to_string(i));
  const auto leaf = [&](const std::string& name) {
    Criterion one{name};
    one.direction = dice.below(2) == 0 ? Direction::benefit : Direction::cost;
    one.weight = dice.between(0, 5);
    for (std::size_t i = 0; i < count; ++i) one.values.push_back(dice.below(6) == 0 ? 0 : dice.between(0, 100));
    return one;
  };
  const std::size_t top = 1 + dice.below(4);
  for (std::size_t i = 0; i < top; ++i) {
    const std::string name = "c" + std::to_string(i);
    if (dice.below(3) != 0) {
      out.criteria.push_back(leaf(name));
      continue;
    }
    Criterion inner{name};
    inner.weight = dice.between(0, 5);
    for (std::size_t k = 0; k <= dice.below(3); ++k) inner.children.push_back(leaf(name + "." + std::to_string(k)));
    out.criteria.push_back(std::move(inner));
  }
  out.criteria.front().weight = 1;  // not all are 0
  return out;
}

Criterion* find(std::vector<Criterion>& criteria, const std::string& name, std::vector<Criterion>** siblings) {
  for (Criterion& one : criteria) {
    if (one.name == name) {
      *siblings = &criteria;
      return &one;
    }
    if (Criterion* below = find(one.children, name, siblings)) return below;
  }
  return nullptr;
}

/// The same with that criterion's local weight, its siblings' in proportion.
RankingProblem with_weight(RankingProblem problem, const std::string& name, double weight) {
  std::vector<Criterion>* siblings = nullptr;
  Criterion* changed = find(problem.criteria, name, &siblings);
  double rest = 0;
  for (const Criterion& one : *siblings) rest += &one == changed ? 0 : *one.weight;
  for (Criterion& one : *siblings) {
    const double part = rest > 0 ? *one.weight / rest : 1.0 / static_cast<double>(siblings->size() - 1);
    one.weight = &one == changed ? weight : part * (1 - weight);
  }
  return problem;
}

}  // namespace

TEST_CASE("measured values: twice the battery counts twice, half the way counts twice, and the answer says why") {
  const auto answer = ranked(ridgeback());
  CHECK(answer.leaves == std::vector<std::string>{"battery", "distance", "availability"});
  for (const CriterionWeight& one : answer.criteria) CHECK(one.global == doctest::Approx(1.0 / 3));
  CHECK(answer.consistency.empty());
  // 80:40:80 are 0.4, 0.2, 0.4; 1/4 : 1/2 : 1/8 are 2/7, 4/7, 1/7; 100:100:50 are 0.4, 0.4, 0.2
  const RankedAlternative& first = answer.ranking[0];
  CHECK(first.id == "pioneer2");
  check_prints(first.contributions, {0.2 / 3, 4.0 / 7 / 3, 0.4 / 3}, 12);
  CHECK(first.score == doctest::Approx((0.2 + 4.0 / 7 + 0.4) / 3));
  CHECK(score_of(answer, "pioneer1") == doctest::Approx((0.4 + 2.0 / 7 + 0.4) / 3));
  CHECK(score_of(answer, "turtlebot") == doctest::Approx((0.4 + 1.0 / 7 + 0.2) / 3));
}

TEST_CASE("the weight at which the winner changes is told, and is the one") {
  const auto answer = ranked(ridgeback());
  REQUIRE(answer.sensitivity.size() == 3);
  const Sensitivity& battery = answer.sensitivity[0];
  CHECK(battery.criterion == "battery");
  CHECK(battery.weight == doctest::Approx(1.0 / 3));
  // pioneer1 0.4 t + (2/7 + 0.4) (1 - t) / 2 reaches pioneer2's 0.2 t + (4/7 + 0.4) (1 - t) / 2 at t = 5/12
  REQUIRE(battery.changes.size() == 1);
  CHECK(battery.changes[0].weight == doctest::Approx(5.0 / 12));
  CHECK(battery.changes[0].winner == "pioneer1");
  // and with distance at t: 2/7 t + 0.4 (1 - t) = 4/7 t + 0.3 (1 - t) at t = 7/27, which is nearer.
  CHECK(answer.sensitivity[1].changes.at(0).weight == doctest::Approx(7.0 / 27));
  CHECK(sensitivity_text(answer) ==
        "'pioneer2' stays first unless 'distance' weighs less than 0.259 among its siblings (now 0.333): "
        "then 'pioneer1' is.");
}

TEST_CASE("sub-criteria: a weight is its share of its parent's") {
  auto problem = ridgeback();
  Criterion energy{"energy"};
  energy.children = {problem.criteria[0], {.name = "health", .values = {1, 1, 1}}};
  problem.criteria[0] = energy;
  problem.people.push_back({});
  problem.people[0].judgments = {{"energy", {{"battery", "health", 3}}}};
  const auto answer = ranked(problem);
  REQUIRE(answer.criteria.size() == 5);
  CHECK(answer.criteria[0].name == "energy");
  CHECK(answer.criteria[1].name == "battery");
  CHECK(answer.criteria[1].level == 2);
  CHECK(answer.criteria[1].local == doctest::Approx(0.75));
  CHECK(answer.criteria[1].global == doctest::Approx(0.25));
  CHECK(answer.criteria[3].global == doctest::Approx(1.0 / 3));
  REQUIRE(answer.consistency.size() == 1);
  CHECK(answer.consistency[0].node == "energy");
}

TEST_CASE("values of 0: without a battery nothing, no way at all takes everything, all alike share alike") {
  auto problem = ridgeback();
  problem.criteria = {{.name = "battery", .values = {0, 50, 50}}};
  CHECK(score_of(ranked(problem), "pioneer1") == 0);
  problem.criteria = {{.name = "distance", .direction = Direction::cost, .values = {0, 3, 0}}};
  CHECK(score_of(ranked(problem), "pioneer1") == 0.5);
  CHECK(score_of(ranked(problem), "pioneer2") == 0);
  for (const Direction direction : {Direction::benefit, Direction::cost}) {
    for (const double value : {0.0, 7.0, 1e-320, 1e300}) {
      problem.criteria = {{.name = "any", .direction = direction, .values = {value, value, value}}};
      for (const RankedAlternative& one : ranked(problem).ranking) CHECK(one.score == doctest::Approx(1.0 / 3));
    }
  }
  // Equal ones are ordered by id.
  CHECK(ranked(problem).ranking[0].id == "pioneer1");
  // Neither the reciprocals nor the sum overflow.
  problem.criteria = {{.name = "any", .direction = Direction::cost, .values = {1e-320, 1, 1e300}}};
  CHECK(ranked(problem).ranking[0].score == doctest::Approx(1));
}

TEST_CASE("a single alternative scores 1, however it was measured or judged") {
  auto problem = ridgeback();
  problem.alternatives = {"pioneer1"};
  problem.criteria = {{.name = "battery", .values = {0}}, {.name = "charm"}};
  problem.people.push_back({});
  problem.people[0].alternative_judgments = {{"charm", {}}};
  const auto answer = ranked(problem);
  REQUIRE(answer.ranking.size() == 1);
  CHECK(answer.ranking[0].score == doctest::Approx(1));
  CHECK(sensitivity_text(answer) == "'pioneer1' stays first whatever any one criterion weighs.");
}

TEST_CASE("weights may be given in relation to each other; only the best may be asked for") {
  auto problem = ridgeback();
  for (std::size_t i = 0; i < 3; ++i) problem.criteria[i].weight = i == 0 ? 2 : 1;
  problem.options.top = 2;
  problem.options.sensitivity = false;
  const auto answer = ranked(problem);
  CHECK(answer.criteria[0].local == 0.5);
  CHECK(answer.ranking.size() == 2);
  CHECK(answer.ranking[0].id == "pioneer1");
  CHECK(answer.sensitivity.empty());
}

TEST_CASE("a ratio over the bound is refused with the judgment that hurts most, and accepted by word") {
  auto problem = ridgeback();
  problem.people.push_back({});
  problem.people[0].judgments = {
      {"replace ridgeback",
       {{"battery", "distance", 5}, {"distance", "availability", 5}, {"availability", "battery", 5}}}};
  check_refused(problem, Errc::conflict, "'replace ridgeback'");
  check_refused(problem, Errc::conflict, "hurts most");
  CHECK(rank(problem).error().hint.find("would fit there") != std::string::npos);
  problem.options.max_ratio = 10;
  const auto answer = ranked(problem);
  CHECK(answer.consistency[0].of.cr > 0.1);
  CHECK(answer.criteria[0].local == doctest::Approx(1.0 / 3));
}

TEST_CASE("wrong problems: each has its answer") {
  const auto refuse = [](void (*change)(RankingProblem&), Errc code, const std::string& words) {
    auto problem = ridgeback();
    problem.people.push_back({});
    change(problem);
    check_refused(problem, code, words);
  };
  using P = RankingProblem&;
  refuse([](P p) { p.goal.clear(); }, Errc::missing, "goal");
  refuse([](P p) { p.criteria.clear(); }, Errc::missing, "criteria");
  refuse([](P p) { p.alternatives.clear(); }, Errc::missing, "alternatives");
  refuse([](P p) { p.alternatives[1] = "pioneer1"; }, Errc::duplicate, "'pioneer1'");
  refuse([](P p) { p.alternatives[1].clear(); }, Errc::missing, "no name");
  refuse([](P p) { p.alternatives[1] = std::string(129, 'a'); }, Errc::too_large, "129 bytes");
  refuse([](P p) { p.criteria[1].name = "battery"; }, Errc::duplicate, "'battery'");
  refuse([](P p) { p.criteria[1].name = p.goal; }, Errc::duplicate, "the goal's");
  refuse([](P p) { p.criteria[1].values.clear(); }, Errc::missing, "neither values nor");
  refuse([](P p) { p.criteria[1].values.pop_back(); }, Errc::bad_value, "2 for 3");
  refuse([](P p) { p.criteria[1].values[2] = std::nan(""); }, Errc::missing, "'turtlebot' has none");
  refuse([](P p) { p.criteria[1].values[2] = -1; }, Errc::bad_value, "'turtlebot' is -1");
  refuse([](P p) { p.criteria[1].values[2] = HUGE_VAL; }, Errc::bad_value, "inf");
  refuse([](P p) { p.criteria[1].values[2] = 1e301; }, Errc::bad_value, "1e+301");
  refuse(
      [](P p) {
        p.people[0].alternative_judgments = {{"distance", {{"pioneer1", "pioneer2", 2}}}};
      },
      Errc::bad_value, "values and alternative_judgments");
  refuse([](P p) { p.criteria[1].children = {{"below"}}; }, Errc::bad_value, "criteria below it");
  refuse([](P p) { p.criteria[1].weight = 1; }, Errc::missing, "'battery' has no weight");
  refuse(
      [](P p) {
        for (auto& one : p.criteria) one.weight = 0;
      },
      Errc::bad_value, "are 0");
  refuse(
      [](P p) {
        for (auto& one : p.criteria) one.weight = -1;
      },
      Errc::bad_value, "no weight");
  refuse(
      [](P p) {
        for (auto& one : p.criteria) one.weight = std::nan("");
      },
      Errc::bad_value, "no weight");
  refuse(
      [](P p) {
        for (auto& one : p.criteria) one.weight = 1;
        p.people[0].judgments = {{p.goal, {{"battery", "distance", 2}}}};
      },
      Errc::bad_value, "weights are given");
  refuse([](P p) { p.people[0].judgments = {{"battry", {}}}; }, Errc::unknown_key, "'battry'");
  refuse([](P p) { p.people[0].judgments = {{"battery", {}}}; }, Errc::unknown_key, "neither the goal");
  refuse([](P p) { p.people[0].alternative_judgments = {{p.goal, {}}}; }, Errc::unknown_key, "'replace ridgeback'");
  refuse([](P p) { p.people[0].judgments = {{p.goal, {}}, {p.goal, {}}}; }, Errc::duplicate, "two lists");
  refuse([](P p) { p.people[0].judgments = {{p.goal, {}}}; }, Errc::missing, "'battery' | 'distance'");
  refuse([](P p) { p.options.max_ratio = -1; }, Errc::bad_value, "max_ratio");
  refuse([](P p) { p.options.max_ratio = std::nan(""); }, Errc::bad_value, "max_ratio");
  refuse([](P p) { p.people.resize(101); }, Errc::too_large, "101");
  refuse(
      [](P p) {
        for (int i = 0; i < 62; ++i) p.criteria.push_back({"c" + std::to_string(i)});
      },
      Errc::too_large, "65");
  refuse(
      [](P p) {
        for (int i = 0; i < 11; ++i) p.criteria = {Criterion{"c" + std::to_string(i), p.criteria}};
      },
      Errc::too_large, "deeper than 10");
  refuse(
      [](P p) {
        for (int i = 3; i <= 20'000; ++i) p.alternatives.push_back("r" + std::to_string(i));
      },
      Errc::too_large, "20001");
}

TEST_CASE("any problem: scores sum to 1 and are the sum of their contributions; names and order do not matter") {
  Dice dice(3);
  for (int round = 0; round < 300; ++round) {
    const auto problem = any_problem(dice);
    const auto answer = ranked(problem);
    double all = 0;
    for (const RankedAlternative& one : answer.ranking) {
      const auto& parts = one.contributions;
      CHECK(std::accumulate(parts.begin(), parts.end(), 0.0) == doctest::Approx(one.score));
      all += one.score;
    }
    CHECK(all == doctest::Approx(1));
    auto turned = problem;
    std::reverse(turned.alternatives.begin(), turned.alternatives.end());
    std::reverse(turned.criteria.begin(), turned.criteria.end());
    for (Criterion& one : turned.criteria) {
      std::reverse(one.values.begin(), one.values.end());
      for (Criterion& child : one.children) std::reverse(child.values.begin(), child.values.end());
      one.name = "other " + one.name;
    }
    const auto other = ranked(turned);
    for (const RankedAlternative& one : answer.ranking) {
      CHECK(score_of(other, one.id) == doctest::Approx(one.score).epsilon(1e-12));
    }
  }
}

TEST_CASE("any problem: beyond each weight that is told its winner wins, and between them nothing changes") {
  Dice dice(11);
  std::size_t changes = 0;
  for (int round = 0; round < 300; ++round) {
    const auto problem = any_problem(dice);
    const auto answer = ranked(problem);
    for (const Sensitivity& one : answer.sensitivity) {
      if (one.changes.empty() && one.weight == 1) continue;  // an only child
      // The winner on each interval from 0 to 1.
      double from = 0;
      for (std::size_t i = 0; i <= one.changes.size(); ++i) {
        const double to = i < one.changes.size() ? one.changes[i].weight : 1;
        REQUIRE(to >= from);
        std::string winner = answer.ranking[0].id;
        if (to <= one.weight && i < one.changes.size()) winner = one.changes[i].winner;
        if (i > 0 && from >= one.weight) winner = one.changes[i - 1].winner;
        const bool here = from < one.weight && one.weight < to;
        for (const double part : {0.001, 0.5, 0.999}) {
          if (to - from < 1e-6) continue;
          const auto moved = ranked(with_weight(problem, one.criterion, from + part * (to - from)));
          CHECK(score_of(moved, winner) == doctest::Approx(moved.ranking[0].score).epsilon(1e-9));
          if (here) CHECK(winner == answer.ranking[0].id);
        }
        from = to;
      }
      changes += one.changes.size();
    }
  }
  CHECK(changes > 100);
}

TEST_CASE("twenty thousand robots by value") {
  RankingProblem problem;
  problem.goal = "goal";
  problem.criteria = {{.name = "battery"}, {.name = "distance", .direction = Direction::cost}};
  Dice dice(5);
  for (std::size_t i = 0; i < kMostAlternatives; ++i) {
    problem.alternatives.push_back("r" + std::to_string(i));
    problem.criteria[0].values.push_back(dice.between(1, 100));
    problem.criteria[1].values.push_back(dice.between(1, 100));
  }
  const auto answer = ranked(problem);
  CHECK(answer.ranking.size() == kMostAlternatives);
  CHECK(answer.ranking.front().score >= answer.ranking.back().score);
}
