// trb-bench-capability: the index of the capability database beside bare SQLite and a bare loop
// (tests/bench/README.md).
#include <chrono>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <functional>
#include <stdexcept>
#include <string>

#include "common/ranking/ranking.hpp"
#include "services/resilience/core/shortlist.hpp"
#include "tests/bench/capability/hall.hpp"

namespace trb::bench {
namespace {

using Clock = std::chrono::steady_clock;
using Robots = std::vector<resilience::RobotNumber>;

constexpr const char* kHelp =
    "trb-bench-capability ROBOTS ROUNDS\n\n"
    "  A line of JSON for each round: what a question for 8 of 256 skills takes the index, SQLite in three ways and a\n"
    "  loop over every robot (microseconds), and what the question with the ten best of 10,000 takes the index and a "
    "loop."
    "\n\nUsually started by scripts/bench capability.";

constexpr std::size_t kRanked = 10'000;
constexpr std::size_t kBest = 10;

/// A method: each one answers the same queries, and must find what the others find.
struct Way {
  const char* name;
  int repeats;
  std::function<void(const Skills&, Robots&)> ask;
};

double microseconds_each(const Way& way, const Hall& hall, int first, std::size_t& found) {
  Robots out;
  const auto begin = Clock::now();
  for (int i = 0; i < way.repeats; ++i) {
    way.ask(hall.question(first + i), out);
    if (i == 0) found = out.size();
  }
  return std::chrono::duration<double, std::micro>(Clock::now() - begin).count() / way.repeats;
}

void check_same(const std::vector<Way>& ways, const Hall& hall) {
  Robots expected, out;
  for (int i = 0; i < 3; ++i) {
    ways.front().ask(hall.question(i), expected);
    if (expected.empty()) throw std::runtime_error("nobody is found: there is nothing to measure");
    for (const Way& way : ways) {
      way.ask(hall.question(i), out);
      if (out != expected) throw std::runtime_error(std::string(way.name) + " finds others");
    }
  }
}

/// The methods run in another order each round, so that none always follows the same one.
void measure(const char* what, const std::vector<Way>& ways, const Hall& hall, int rounds) {
  check_same(ways, hall);
  for (int round = 0; round < rounds; ++round) {
    std::string line;
    std::size_t found = 0;
    for (std::size_t i = 0; i < ways.size(); ++i) {
      const Way& way = ways[(i + static_cast<std::size_t>(round)) % ways.size()];
      char text[80];
      std::snprintf(text, sizeof text, ",\"%s\":%.3f", way.name, microseconds_each(way, hall, round, found));
      line += text;
    }
    std::printf("{\"what\":\"%s\",\"robots\":%zu,\"found\":%zu%s}\n", what, hall.size(), found, line.c_str());
    std::fflush(stdout);
  }
}

void questions(std::size_t robots, int rounds) {
  const Hall hall(robots, 250);
  const auto index = hall.index();
  Database database(hall);
  const std::vector<Way> ways = {
      {"index", 100, [&](const Skills& asked, Robots& out) { index->query(words_of(asked), out); }},
      {"loop", 3, [&](const Skills& asked, Robots& out) { hall.loop(asked, out); }},
      {"sql_group", 2, [&](const Skills& asked, Robots& out) { database.ask(Database::kGroup, asked, out); }},
      {"sql_intersect", 2, [&](const Skills& asked, Robots& out) { database.ask(Database::kIntersect, asked, out); }},
      {"sql_join", 2, [&](const Skills& asked, Robots& out) { database.ask(Database::kJoin, asked, out); }},
  };
  measure("query", ways, hall, rounds);
}

/// Every robot has all that is asked for: as many results as robots, the most that there is to write.
void everybody(std::size_t robots, int rounds) {
  const Hall hall(robots, 1);
  const auto index = hall.index();
  const std::vector<Way> ways = {
      {"index", 20, [&](const Skills& asked, Robots& out) { index->query(words_of(asked), out); }},
      {"loop", 3, [&](const Skills& asked, Robots& out) { hall.loop(asked, out); }},
  };
  measure("everybody", ways, hall, rounds);
}

/// The whole AHP, as trb rank does it, with an answer that explains the ten best.
void rank_all(const resilience::FleetIndex& index, const Robots& candidates, const resilience::Weights& weights,
              resilience::HallPoint place, Robots& out) {
  Criterion charge{.name = "battery", .weight = weights.charge};
  Criterion distance{.name = "distance", .weight = weights.distance, .direction = Direction::cost};
  Criterion availability{.name = "availability", .weight = weights.availability};
  RankingProblem problem;
  problem.goal = "replace";
  problem.options.top = kBest;
  for (const resilience::RobotNumber robot : candidates) {
    const resilience::Measures& of = index.measures(robot);
    problem.alternatives.push_back(index.id_of(robot));
    charge.values.push_back(of.charge);
    const double east = of.x - place.x, north = of.y - place.y;
    distance.values.push_back(resilience::kWayStart + std::sqrt(east * east + north * north));
    availability.values.push_back(of.availability);
  }
  problem.criteria = {std::move(charge), std::move(distance), std::move(availability)};
  const auto answer = rank(problem);
  if (!answer) throw std::runtime_error(answer.error().text());
  out.clear();
  for (const RankedAlternative& one : answer->ranking) out.push_back(*index.find(one.id));
}

void ten_best(std::size_t models, const char* what, int rounds) {
  const Hall hall(kRanked, models);
  const auto index = hall.index();
  const resilience::Weights weights{0.5, 0.3, 0.2};
  const resilience::HallPoint place{20, 30};
  Robots candidates;
  const auto keep = [](const std::vector<resilience::Scored>& best, Robots& out) {
    out.clear();
    for (const resilience::Scored& one : best) out.push_back(one.robot);
  };
  const std::vector<Way> ways = {
      {"index", 200,
       [&](const Skills& asked, Robots& out) {
         index->query(words_of(asked), candidates);
         keep(resilience::shortlist(*index, candidates, weights, place, kBest), out);
       }},
      {"index_rank", 20,
       [&](const Skills& asked, Robots& out) {
         index->query(words_of(asked), candidates);
         rank_all(*index, candidates, weights, place, out);
       }},
      {"loop", 200, [&](const Skills& asked, Robots& out) { keep(hall.ten_best(asked, weights, place, kBest), out); }},
  };
  measure(what, ways, hall, rounds);
}

}  // namespace
}  // namespace trb::bench

int main(int argc, char** argv) {
  using namespace trb::bench;
  const long robots = argc == 3 ? std::strtol(argv[1], nullptr, 10) : 0;
  const long rounds = argc == 3 ? std::strtol(argv[2], nullptr, 10) : 0;
  if (robots < 1000 || robots > 2'000'000 || rounds < 1 || rounds > 1000) {
    std::puts(kHelp);
    return argc == 2 && std::string(argv[1]) == "--help" ? 0 : 2;
  }
  try {
    questions(static_cast<std::size_t>(robots), static_cast<int>(rounds));
    everybody(static_cast<std::size_t>(robots), static_cast<int>(rounds));
    ten_best(1, "ten_best", static_cast<int>(rounds));
    ten_best(10, "ten_best_of_a_tenth", static_cast<int>(rounds));
  } catch (const std::exception& problem) {
    std::fprintf(stderr, "trb-bench-capability: %s\n", problem.what());
    return 1;
  }
  return 0;
}
