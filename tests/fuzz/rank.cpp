// A ranking as in a file, and its answer: any bytes give an answer with finite scores, or an error.
#include <cmath>

#include "common/ranking/ranking_json.hpp"
#include "tests/fuzz/bits.hpp"
#include "tests/fuzz/target.hpp"

namespace trb::fuzz {
namespace {

void check_error(const Error& error) {
  require(error.code != Errc::ok && !error.what.empty() && !error.hint.empty(), "an error has a text and a cure");
}

void check_answer(const RankingProblem& problem, const RankingAnswer& answer) {
  require(answer.ranking.size() == problem.alternatives.size(), "every alternative is ranked");
  double all = 0;
  double before = 1 + 1e-9;
  for (const RankedAlternative& one : answer.ranking) {
    require(one.score >= 0 && one.score <= before + 1e-11, "scores are numbers, and fall");
    before = one.score;
    all += one.score;
    double parts = 0;
    for (const double part : one.contributions) parts += part;
    require(std::abs(parts - one.score) < 1e-9, "a score is the sum of its contributions");
  }
  require(std::abs(all - 1) < 1e-9, "scores sum to 1");
  for (const CriterionWeight& one : answer.criteria) {
    require(one.local >= 0 && one.local <= 1 + 1e-9 && one.global <= 1 + 1e-9, "weights are shares");
  }
  for (const NodeConsistency& one : answer.consistency) {
    require(one.of.cr >= 0 && one.of.cr <= problem.options.max_ratio + 1e-9, "no ratio is over the bound");
  }
  for (const Sensitivity& one : answer.sensitivity) {
    double last = 0;
    for (const WinnerChange& change : one.changes) {
      require(change.weight >= last && change.weight <= 1, "the winner changes at rising weights");
      last = change.weight;
    }
  }
  require(parse_json(dump_json(ranking_value(answer)), kRankingLimits).ok(), "the answer is JSON");
  require(!sensitivity_text(answer).empty(), "the answer has its sentence");
}

double some_number(Bits& bits) {
  constexpr double kNumbers[] = {0,    1,     2,   0.5, 3,  1.0 / 3, 9,   1e9,     1e-9, 1e300,  5e-324,
                                 1e10, -1e-9, 100, 7,   80, 4.2,     NAN, 1.7e308, 5,    1.0 / 7};
  return bits.one_of(kNumbers);
}

std::vector<Judgment> judgments_of(Bits& bits, const std::vector<std::string>& names) {
  std::vector<Judgment> out;
  const std::size_t left_out = bits.below(5);
  for (std::size_t i = 0; i < names.size(); ++i) {
    for (std::size_t j = i + 1; j < names.size(); ++j) {
      if (left_out == 0 || bits.below(left_out + 1) != 0) out.push_back({names[i], names[j], some_number(bits)});
    }
  }
  return out;
}

/// A problem that is mostly valid: mutated JSON rarely is.
RankingProblem problem_of(BytesView input) {
  Bits bits(input);
  RankingProblem out;
  out.goal = "goal";
  for (std::size_t i = 0; i <= bits.below(6); ++i) out.alternatives.push_back("a" + std::to_string(i));
  out.people.resize(1 + bits.below(2));
  std::vector<std::string> names;
  for (std::size_t i = 0; i <= bits.below(6); ++i) {
    Criterion one{names.emplace_back("c" + std::to_string(i))};
    one.direction = static_cast<Direction>(bits.below(2));
    if (bits.below(3) == 0) {
      out.people[0].alternative_judgments.push_back({one.name, judgments_of(bits, out.alternatives)});
    } else {
      for (std::size_t k = 0; k < out.alternatives.size(); ++k) one.values.push_back(some_number(bits));
    }
    out.criteria.push_back(std::move(one));
  }
  for (Person& person : out.people) person.judgments.push_back({"goal", judgments_of(bits, names)});
  out.options.method = static_cast<WeightMethod>(bits.below(2));
  out.options.max_ratio = bits.below(2) == 0 ? 1e9 : 0.1;
  return out;
}

void try_problem(const RankingProblem& problem) {
  const auto answer = rank(problem);
  if (!answer) return check_error(answer.error());
  check_answer(problem, *answer);
}

}  // namespace

std::vector<Bytes> seeds() {
  return {
      R"j({"goal":"replace ridgeback","criteria":[{"name":"battery","unit":"%"},{"name":"distance","direction":"cost",
        "unit":"m"},{"name":"charm"}],"judgments":{"replace ridgeback":[["battery","distance",3],["battery","charm","1/2"],
        ["distance","charm","1/5"]]},"alternatives":[{"id":"a","values":{"battery":80,"distance":4.2}},
        {"id":"b","values":{"battery":0,"distance":0}}],"alternative_judgments":{"charm":[["a","b",5]]},
        "options":{"method":"eigenvector","max_ratio":0.5}})j",
      R"j({"goal":"g","criteria":[{"name":"x","children":[{"name":"x1"},{"name":"x2","direction":"cost"},{"name":"x3"}]},
        {"name":"y"}],"alternatives":[{"id":"a","values":{"x1":1,"x2":2,"x3":3,"y":4}},{"id":"b","values":{"x1":2,
        "x2":1e300,"x3":1e-300,"y":4}},{"id":"c","values":{"x1":0,"x2":0,"x3":9,"y":4}}],"people":[{"name":"ann",
        "weight":3,"judgments":{"x":[["x1","x2",2],["x3","x1",1e9]]}},{"judgments":{"x":[["x1","x2","8/1"]],
        "g":[["x","y",3]]}}],"options":{"method":"geometric_mean","max_ratio":1000}})j",
      R"j({"goal":"g","criteria":[{"name":"x","weight":0},{"name":"y","weight":2.5}],"alternatives":[{"id":"a",
        "values":{"x":1,"y":2}},{"id":"b","values":{"x":2,"y":1}}]})j",
      Bytes("\x02\x00\x03\x01\x01\x0d\x0e\x0f\x00\x01\x10\x03\x06\x01\x01\x02\x03\x04\x01\x02\x03\x00\x00", 23)};
}

void run(BytesView input) {
  try_problem(problem_of(input));
  const auto json = parse_json(input, kRankingLimits);
  if (!json) return;
  const auto problem = read_ranking(*json);
  if (!problem) return check_error(problem.error());
  try_problem(*problem);
}

}  // namespace trb::fuzz
