#include "common/ranking/pairwise.hpp"

#include "common/ranking/test_ranking.hpp"

using namespace trb;
using namespace trb::ranking_test;

namespace {

const std::vector<std::string> kThree{"a", "b", "c"};

Result<Priorities> weigh_one(const std::vector<std::string>& items, const std::vector<Judgment>& list,
                             WeightMethod method = WeightMethod::eigenvector) {
  return weigh("it", items, {{1, list}}, method);
}

/// Refused with this code; the text names the node and contains these words, and there is a hint.
void check_refused(const std::vector<std::string>& items, const std::vector<Judgment>& list, Errc code,
                   const std::string& words) {
  const auto found = weigh_one(items, list);
  REQUIRE_FALSE(found.ok());
  CHECK(found.error().code == code);
  CHECK(found.error().what.find("'it'") != std::string::npos);
  CHECK_MESSAGE(found.error().what.find(words) != std::string::npos, found.error().what);
  CHECK_FALSE(found.error().hint.empty());
}

std::vector<std::string> names(std::size_t count) {
  std::vector<std::string> out;
  for (std::size_t i = 0; i < count; ++i) out.push_back("n" + std::to_string(i));
  return out;
}

}  // namespace

TEST_CASE("one thing weighs 1, two weigh as they were judged: nothing can disagree") {
  const auto one = weigh_one({"a"}, {});
  REQUIRE(one.ok());
  CHECK(one->weights == std::vector<double>{1});
  CHECK(one->consistency.lambda_max == 1);
  const auto two = weigh_one({"a", "b"}, {{"b", "a", 4}});
  REQUIRE(two.ok());
  CHECK(two->weights[0] == doctest::Approx(0.2));
  CHECK(two->consistency.lambda_max == 2);
  CHECK(two->consistency.ci == 0);
  CHECK(two->consistency.cr == 0);
}

TEST_CASE("judgments that agree give the weights they were made from, exactly, and a ratio of 0") {
  Dice dice(1);
  for (std::size_t n = 1; n <= kMostJudged; ++n) {
    const auto items = names(n);
    std::vector<double> weights;
    double sum = 0;
    for (std::size_t i = 0; i < n; ++i) sum += weights.emplace_back(std::exp(dice.between(-4, 4)));
    std::vector<double> judged;
    for (std::size_t i = 0; i < n; ++i) {
      for (std::size_t j = i + 1; j < n; ++j) judged.push_back(weights[i] / weights[j]);
    }
    for (const WeightMethod method : {WeightMethod::eigenvector, WeightMethod::geometric_mean}) {
      const auto found = weigh_one(items, upper(items, judged), method);
      REQUIRE(found.ok());
      CHECK(found->consistency.cr == 0);
      CHECK(found->consistency.lambda_max == static_cast<double>(n));
      for (std::size_t i = 0; i < n; ++i) CHECK(found->weights[i] == doctest::Approx(weights[i] / sum).epsilon(1e-12));
    }
  }
}

TEST_CASE("a missing judgment follows from the others (Harker 1987)") {
  // Of the chain a = 2 b, b = 2 c Harker's matrix is {2 2 0, 1/2 1 2, 0 1/2 2}: 4/7, 2/7, 1/7.
  for (const WeightMethod method : {WeightMethod::eigenvector, WeightMethod::geometric_mean}) {
    const auto found = weigh_one(kThree, {{"a", "b", 2}, {"b", "c", 2}}, method);
    REQUIRE(found.ok());
    check_prints(found->weights, {4.0 / 7, 2.0 / 7, 1.0 / 7}, 12);
    CHECK(found->consistency.cr == 0);
  }
  // A long chain is the slowest to converge.
  std::vector<Judgment> chain;
  const auto items = names(kMostJudged);
  for (std::size_t i = 1; i < items.size(); ++i) chain.push_back({items[i - 1], items[i], 3});
  const auto found = weigh_one(items, chain);
  REQUIRE(found.ok());
  CHECK(found->weights[0] / found->weights[14] == doctest::Approx(std::pow(3, 14)));
}

TEST_CASE("a judgment filled with what the weights say changes nothing: for both methods") {
  // On optimal completion of incomplete pairwise comparison matrices (Bozoki, Fulop, Ronyai 2010): their matrix U.
  const std::vector<std::string> items{"a", "b", "c", "d"};
  std::vector<Judgment> list{{"a", "b", 1}, {"a", "c", 5}, {"a", "d", 2}, {"b", "c", 3}, {"b", "d", 4}};
  for (const WeightMethod method : {WeightMethod::eigenvector, WeightMethod::geometric_mean}) {
    const auto without = weigh_one(items, list, method);
    REQUIRE(without.ok());
    auto filled = list;
    filled.push_back({"c", "d", without->weights[2] / without->weights[3]});
    const auto with = weigh_one(items, filled, method);
    REQUIRE(with.ok());
    for (std::size_t i = 0; i < 4; ++i) CHECK(with->weights[i] == doctest::Approx(without->weights[i]).epsilon(1e-10));
    if (method == WeightMethod::eigenvector) {
      CHECK(with->consistency.lambda_max == doctest::Approx(without->consistency.lambda_max).epsilon(1e-10));
    }
  }
}

TEST_CASE("the geometric mean: the rows' means, where the eigenvector differs") {
  const auto found =
      weigh_one({"a", "b", "c", "d"}, upper({"a", "b", "c", "d"}, {2, 5, 1, 1, 7, 3}), WeightMethod::geometric_mean);
  REQUIRE(found.ok());
  const std::vector<double> rows{std::pow(2.0 * 5 * 1, .25), std::pow(0.5 * 1 * 7, .25), std::pow(0.2 * 1 * 3, .25),
                                 std::pow(1.0 / 7 / 3, .25)};
  double sum = 0;
  for (const double row : rows) sum += row;
  for (std::size_t i = 0; i < 4; ++i) CHECK(found->weights[i] == doctest::Approx(rows[i] / sum));
}

TEST_CASE("several people: the geometric mean of what they say, by how much they count") {
  const std::vector<Judgment> low{{"a", "b", 2}};
  const std::vector<Judgment> high{{"b", "a", 1.0 / 8}};
  const auto even = weigh("it", {"a", "b"}, {{1, low}, {1, high}}, WeightMethod::eigenvector);
  REQUIRE(even.ok());
  CHECK(even->weights[0] / even->weights[1] == doctest::Approx(4));
  const auto uneven = weigh("it", {"a", "b"}, {{3, low}, {1, high}}, WeightMethod::eigenvector);
  REQUIRE(uneven.ok());
  CHECK(uneven->weights[0] / uneven->weights[1] == doctest::Approx(std::pow(2, 0.75) * std::pow(8, 0.25)));
  // A person who did not judge a pair does not count for it.
  const std::vector<Judgment> other{{"b", "c", 5}};
  const auto apart = weigh("it", kThree, {{1, low}, {7, other}}, WeightMethod::eigenvector);
  REQUIRE(apart.ok());
  CHECK(apart->weights[0] / apart->weights[1] == doctest::Approx(2));
  CHECK(apart->weights[1] / apart->weights[2] == doctest::Approx(5));
  const auto nobody = weigh("it", {"a", "b"}, {{1, high}, {0, low, "ann"}}, WeightMethod::eigenvector);
  REQUIRE_FALSE(nobody.ok());
  CHECK(nobody.error().what == "'ann': judgments of 'it': a person counts 0");
  CHECK_FALSE(weigh("it", {"a", "b"}, {{std::nan(""), low}}, WeightMethod::eigenvector).ok());
}

TEST_CASE("the judgment that hurts most is named, with what would fit") {
  // a = 2 b and b = 2 c, so a should be 4 c, not c / 9.
  const auto found = weigh_one(
      {"a", "b", "c", "d"}, {{"a", "b", 2}, {"b", "c", 2}, {"c", "a", 9}, {"a", "d", 8}, {"b", "d", 4}, {"c", "d", 2}});
  REQUIRE(found.ok());
  CHECK(found->consistency.cr > 0.1);
  REQUIRE(found->worst.has_value());
  CHECK(found->worst->a == "c");
  CHECK(found->worst->b == "a");
  CHECK(found->worst->times == doctest::Approx(9));
  CHECK(found->fits < 3);
  CHECK_FALSE(weigh_one(kThree, {{"a", "b", 2}, {"b", "c", 2}, {"a", "c", 4}})->worst.has_value());
  const auto three = weigh_one(kThree, {{"a", "b", 2}, {"c", "a", 9}, {"b", "c", 2}});
  REQUIRE(three.ok());
  CHECK(three->worst->a == "c");
  CHECK(three->fits == doctest::Approx(9 / std::cbrt(36)));
}

TEST_CASE("wrong judgments: each has its answer") {
  check_refused(kThree, {{"a", "b", 0}}, Errc::bad_value, "no positive number");
  check_refused(kThree, {{"a", "b", -3}}, Errc::bad_value, "no positive number");
  check_refused(kThree, {{"a", "b", std::nan("")}}, Errc::bad_value, "no positive number");
  check_refused(kThree, {{"a", "b", HUGE_VAL}}, Errc::bad_value, "no positive number");
  check_refused(kThree, {{"a", "b", 1e10}}, Errc::bad_value, "up to 1e9");
  check_refused(kThree, {{"a", "a", 1}}, Errc::bad_value, "with itself");
  check_refused(kThree, {{"a", "x", 2}}, Errc::unknown_key, "no 'x'");
  check_refused(kThree, {{"a", "b", 2}, {"a", "b", 2}}, Errc::duplicate, "twice");
  check_refused(kThree, {{"a", "b", 2}, {"b", "a", 2}}, Errc::bad_value, "not its reciprocal");
  check_refused({}, {}, Errc::missing, "nothing to weigh");
  check_refused(names(16), upper(names(16), std::vector<double>(120, 1)), Errc::too_large, "16");
}

TEST_CASE("both directions may be told if they fit: people round") {
  const auto found = weigh_one({"a", "b"}, {{"a", "b", 3}, {"b", "a", 0.333}});
  REQUIRE(found.ok());
  CHECK(found->weights[0] == doctest::Approx(0.75));
}

TEST_CASE("groups that nothing compares with each other are named") {
  check_refused({"a", "b", "c", "d", "e"}, {{"a", "c", 2}, {"b", "d", 3}}, Errc::missing, "'a', 'c' | 'b', 'd' | 'e'");
  check_refused({"a", "b"}, {}, Errc::missing, "'a' | 'b'");
}

TEST_CASE("judgments as far apart as they may be end in weights, or in an answer") {
  Dice dice(7);
  for (int round = 0; round < 300; ++round) {
    const auto items = names(2 + dice.below(14));
    std::vector<Judgment> list;
    for (const Judgment& one : upper(items, std::vector<double>(items.size() * (items.size() - 1) / 2, 1))) {
      if (dice.below(4) == 0) continue;
      list.push_back({one.a, one.b, std::pow(10, dice.between(-9, 9))});
    }
    const auto found = weigh_one(items, list);
    if (!found) {
      CHECK((found.error().code == Errc::missing || found.error().code == Errc::conflict));
      continue;
    }
    double sum = 0;
    for (const double weight : found->weights) {
      CHECK((weight >= 0 && weight <= 1));
      sum += weight;
    }
    CHECK(sum == doctest::Approx(1));
    CHECK(found->consistency.cr >= 0);
    CHECK(std::isfinite(found->consistency.cr));
  }
}
