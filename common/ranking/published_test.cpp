// Published examples, reproduced to the digits that are printed.
#include <map>

#include "common/ranking/test_ranking.hpp"

using namespace trb;
using namespace trb::ranking_test;

namespace {

struct Leaf {
  std::string name;
  std::vector<double> judged;  ///< the alternatives' matrix above its diagonal
};

RankingProblem problem_of(const std::string& goal, const std::vector<double>& judged, const std::vector<Leaf>& leaves,
                          const std::vector<std::string>& alternatives) {
  RankingProblem out;
  out.goal = goal;
  out.alternatives = alternatives;
  out.people.push_back({});
  std::vector<std::string> names;
  for (const Leaf& leaf : leaves) {
    names.push_back(leaf.name);
    out.criteria.push_back({leaf.name});
    out.people[0].alternative_judgments.push_back({leaf.name, upper(alternatives, leaf.judged)});
  }
  out.people[0].judgments.push_back({goal, upper(names, judged)});
  return out;
}

std::vector<double> weights_of(const RankingAnswer& answer) {
  std::vector<double> out;
  for (const CriterionWeight& one : answer.criteria) out.push_back(one.local);
  return out;
}

std::map<std::string, double> scores_of(const RankingAnswer& answer) {
  std::map<std::string, double> out;
  for (const RankedAlternative& one : answer.ranking) out[one.id] = one.score;
  return out;
}

Consistency consistency_of(const RankingAnswer& answer, const std::string& node) {
  for (const NodeConsistency& one : answer.consistency) {
    if (one.node == node) return one.of;
  }
  FAIL("nothing is told of " << node);
  return {};
}

/// Saaty prints the index and the ratio from a lambda that he has rounded: the last digit may be off by one.
void check_consistency(const Consistency& found, double lambda, double index, double ratio) {
  CHECK(prints(found.lambda_max, lambda, 3));
  CHECK(found.ci == doctest::Approx(index).scale(1).epsilon(0.001));
  CHECK(found.cr == doctest::Approx(ratio).scale(1).epsilon(0.001));
}

Priorities weighed(const std::vector<std::string>& items, const std::vector<double>& judged) {
  const auto list = upper(items, judged);
  const auto found = weigh("it", items, {{1, list}}, WeightMethod::eigenvector);
  REQUIRE(found.ok());
  return *found;
}

}  // namespace

// T. L. Saaty, How to make a decision: the analytic hierarchy process. European Journal of Operational Research 48
// (1990) 9-26: buying a house. Of its small matrices those are compared in digits whose print has no slip of its own
// (neighborhood's .745 for .754, financing's .650 and .278 for .649 and .279).
TEST_CASE("Saaty 1990, a house: eight criteria, three houses, judgments that contradict each other") {
  const std::vector<double> judged{5,       3,       7,       6,       6,       1.0 / 3, 1.0 / 4,  // size of house
                                   1.0 / 3, 5,       3,       3,       1.0 / 5, 1.0 / 7,           // transportation
                                   6,       3,       4,       6,       1.0 / 5,                    // neighborhood
                                   1.0 / 3, 1.0 / 4, 1.0 / 7, 1.0 / 8,                             // age of house
                                   1.0 / 2, 1.0 / 5, 1.0 / 6,                                      // yard space
                                   1.0 / 5, 1.0 / 6,                                               // modern facilities
                                   1.0 / 2};  // general condition, financing
  auto problem = problem_of("satisfaction with house", judged,
                            {{"size", {6, 8, 4}},
                             {"transportation", {7, 1.0 / 5, 1.0 / 8}},
                             {"neighborhood", {8, 6, 1.0 / 4}},
                             {"age", {1, 1, 1}},
                             {"yard", {5, 4, 1.0 / 3}},
                             {"facilities", {8, 6, 1.0 / 5}},
                             {"condition", {1.0 / 2, 1.0 / 2, 1}},
                             {"financing", {1.0 / 7, 1.0 / 5, 3}}},
                            {"A", "B", "C"});
  const auto refused = rank(problem);
  REQUIRE_FALSE(refused.ok());
  CHECK(refused.error().code == Errc::conflict);

  problem.options.max_ratio = 0.25;
  const auto answer = rank(problem);
  REQUIRE(answer.ok());
  check_prints(weights_of(*answer), {.173, .054, .188, .018, .031, .036, .167, .333}, 3);
  check_consistency(consistency_of(*answer, "satisfaction with house"), 9.669, .238, .169);
  check_consistency(consistency_of(*answer, "size"), 3.136, .068, .117);
  check_consistency(consistency_of(*answer, "transportation"), 3.247, .124, .213);
  check_consistency(consistency_of(*answer, "age"), 3.000, .000, .000);
  check_consistency(consistency_of(*answer, "yard"), 3.086, .043, .074);
  check_consistency(consistency_of(*answer, "facilities"), 3.197, .099, .170);
  check_consistency(consistency_of(*answer, "condition"), 3.000, .000, .000);
  check_consistency(consistency_of(*answer, "financing"), 3.065, .032, .056);
  check_prints(weighed({"A", "B", "C"}, {6, 8, 4}).weights, {.754, .181, .065}, 3);
  check_prints(weighed({"A", "B", "C"}, {5, 4, 1.0 / 3}).weights, {.674, .101, .226}, 3);
  check_prints(weighed({"A", "B", "C"}, {8, 6, 1.0 / 5}).weights, {.747, .060, .193}, 3);
  check_prints(weighed({"A", "B", "C"}, {1.0 / 2, 1.0 / 2, 1}).weights, {.200, .400, .400}, 3);
  auto scores = scores_of(*answer);
  check_prints({scores["A"], scores["B"], scores["C"]}, {.396, .341, .263}, 3);
  CHECK(answer->ranking[0].id == "A");
}

// T. L. Saaty, Theory and Applications of the Analytic Network Process, RWS Publications 2005: the best city to live
// in.
TEST_CASE("Saaty 2005, a city: five criteria, four cities, judgments between Saaty's numbers") {
  const auto problem = problem_of("best city", {1.0 / 5, 3, 1.0 / 2, 5, 7, 1, 7, 1.0 / 4, 3, 7},
                                  {{"culture", {1.0 / 2, 1, 1.0 / 2, 2.5, 1, 1 / 2.5}},
                                   {"family", {2, 1.0 / 3, 4, 1.0 / 8, 2, 9}},
                                   {"housing", {5, 1.0 / 2, 2.5, 1.0 / 9, 1.0 / 4, 7}},
                                   {"jobs", {1.0 / 2, 3, 4, 6, 8, 1}},
                                   {"transportation", {1.5, 1.0 / 2, 4, 1 / 3.5, 2.5, 9}}},
                                  {"Bethesda", "Boston", "Pittsburgh", "Santa Fe"});
  const auto answer = rank(problem);
  REQUIRE(answer.ok());
  auto scores = scores_of(*answer);
  check_prints({scores["Bethesda"], scores["Boston"], scores["Pittsburgh"], scores["Santa Fe"]},
               {.229, .275, .385, .111}, 3);
  CHECK(answer->ranking[0].id == "Pittsburgh");
}

// Wikipedia, "Analytic hierarchy process - leader example": four criteria, three candidates. It prints .547 for the
// first criterion, so that the printed weights sum to 1; without that it is .5476.
TEST_CASE("the leader example: Dick leads") {
  const auto problem = problem_of("most suitable leader", {4, 3, 7, 1.0 / 3, 3, 5},
                                  {{"experience", {1.0 / 4, 4, 9}},
                                   {"education", {3, 1.0 / 5, 1.0 / 7}},
                                   {"charisma", {5, 9, 4}},
                                   {"age", {1.0 / 3, 5, 9}}},
                                  {"Tom", "Dick", "Harry"});
  const auto answer = rank(problem);
  REQUIRE(answer.ok());
  check_prints(weights_of(*answer), {.548, .127, .270, .056}, 3);
  CHECK(prints(consistency_of(*answer, "most suitable leader").cr, .044, 3));
  check_prints(weighed({"Tom", "Dick", "Harry"}, {1.0 / 4, 4, 9}).weights, {.217, .717, .066}, 3);
  check_prints(weighed({"Tom", "Dick", "Harry"}, {3, 1.0 / 5, 1.0 / 7}).weights, {.188, .081, .731}, 3);
  check_prints(weighed({"Tom", "Dick", "Harry"}, {5, 9, 4}).weights, {.743, .194, .063}, 3);
  check_prints(weighed({"Tom", "Dick", "Harry"}, {1.0 / 3, 5, 9}).weights, {.265, .672, .063}, 3);
  auto scores = scores_of(*answer);
  check_prints({scores["Tom"], scores["Dick"], scores["Harry"]}, {.358, .493, .149}, 3);
}

// T. L. Saaty, Decision making with the analytic hierarchy process. Int. J. Services Sciences 1 (2008) 83-98: which
// drink is consumed more in the USA?
TEST_CASE("Saaty 2008, drinks: seven things by judgment") {
  const auto found = weighed({"coffee", "wine", "tea", "beer", "soda", "milk", "water"},
                             {9,       5,       2,       1,       1,       1.0 / 2,  // coffee
                              1.0 / 3, 1.0 / 9, 1.0 / 9, 1.0 / 9, 1.0 / 9,           // wine
                              1.0 / 3, 1.0 / 4, 1.0 / 3, 1.0 / 9,                    // tea
                              1.0 / 2, 1,       1.0 / 3,                             // beer
                              2,       1.0 / 2,                                      // soda
                              1.0 / 3});                                             // milk, water
  check_prints(found.weights, {.177, .019, .042, .116, .190, .129, .327}, 3);
  CHECK(prints(found.consistency.cr, .022, 3));
}

// T. L. Saaty, A scaling method for priorities in hierarchical structures. J. Mathematical Psychology 15 (1977)
// 234-281: the wealth of nations; the distance from Philadelphia; the light on four chairs, judged twice.
TEST_CASE("Saaty 1977: wealth, distances and light by judgment") {
  const auto wealth = weighed({"USA", "USSR", "China", "France", "UK", "Japan", "Germany"},
                              {4,       9,       6,       6,       5, 5,  // USA
                               7,       5,       5,       3,       4,     // USSR
                               1.0 / 5, 1.0 / 5, 1.0 / 7, 1.0 / 5,        // China
                               1,       1.0 / 3, 1.0 / 3,                 // France
                               1.0 / 3, 1.0 / 3,                          // UK
                               2});                                       // Japan, Germany
  check_prints(wealth.weights, {.427, .230, .021, .052, .052, .123, .094}, 3);
  CHECK(prints(wealth.consistency.lambda_max, 7.61, 2));

  const auto distance =
      weighed({"Cairo", "Tokyo", "Chicago", "San Francisco", "London", "Montreal"}, {1.0 / 3, 8, 3, 3, 7,  // Cairo
                                                                                     9, 3, 3, 9,           // Tokyo
                                                                                     1.0 / 6, 1.0 / 5, 2,  // Chicago
                                                                                     1.0 / 3, 6,  // San Francisco
                                                                                     6});         // London, Montreal
  check_prints(distance.weights, {.262, .397, .033, .116, .164, .027}, 3);
  CHECK(prints(distance.consistency.lambda_max, 6.45, 2));

  const std::vector<std::string> chairs{"C1", "C2", "C3", "C4"};
  const auto first = weighed(chairs, {5, 6, 7, 4, 6, 4});
  check_prints(first.weights, {.62, .24, .10, .05}, 2);
  CHECK(prints(first.consistency.lambda_max, 4.39, 2));
  const auto second = weighed(chairs, {4, 6, 7, 3, 4, 2});
  check_prints(second.weights, {.62, .22, .10, .06}, 2);
  CHECK(prints(second.consistency.lambda_max, 4.10, 2));
}
