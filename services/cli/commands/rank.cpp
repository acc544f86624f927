// rank.
#include <cstdio>

#include "common/base/files.hpp"
#include "common/operator/rank_text.hpp"
#include "services/cli/commands/command.hpp"
#include "services/cli/core/table.hpp"
#include "services/cli/io/print.hpp"

namespace trb::cli {
namespace {

constexpr std::size_t kMostRows = 20;

std::string shown_share(double number) {
  char out[32];
  std::snprintf(out, sizeof out, "%.3f", number);
  return out;
}

Result<Bytes> read_standard_input(std::size_t most) {
  Bytes out;
  char buffer[65536];
  while (const std::size_t count = std::fread(buffer, 1, sizeof buffer, stdin)) {
    out.append(buffer, count);
    if (out.size() > most) return fail(Errc::too_large, "-: over " + std::to_string(most) + " bytes", "rank fewer");
  }
  return out;
}

Result<RankingAnswer> rank_file(const std::string& path) {
  const auto text = path == "-" ? read_standard_input(kRankingLimits.bytes) : read_file(path, kRankingLimits.bytes);
  if (!text) {
    return fail(text.error().code, text.error().what,
                text.error().hint.empty() ? "name a file like config/rank/paper-figure-8.json, or - for standard input"
                                          : text.error().hint);
  }
  return op::rank_text(*text, path);
}

void print_weights(const RankingAnswer& answer) {
  std::vector<std::vector<std::string>> rows{{"CRITERION", "WEIGHT", "OF ALL"}};
  for (const CriterionWeight& one : answer.criteria) {
    rows.push_back({std::string(2 * (one.level - 1), ' ') + one.name, shown_share(one.local), shown_share(one.global)});
  }
  print(format_table(rows) + "\n");
  if (answer.consistency.empty()) return;
  rows = {{"JUDGMENTS OF", "LAMBDA MAX", "INDEX", "RATIO"}};
  for (const NodeConsistency& one : answer.consistency) {
    rows.push_back({one.node, shown_share(one.of.lambda_max), shown_share(one.of.ci), shown_share(one.of.cr)});
  }
  print(format_table(rows) + "\n");
}

void print_ranking(const RankingAnswer& answer) {
  std::vector<std::vector<std::string>> rows{{"", "ALTERNATIVE", "SCORE"}};
  for (const std::string& leaf : answer.leaves) rows.front().push_back(leaf);
  for (std::size_t i = 0; i < answer.ranking.size() && i < kMostRows; ++i) {
    const RankedAlternative& one = answer.ranking[i];
    std::vector<std::string> row{std::to_string(i + 1), one.id, shown_share(one.score)};
    for (const double part : one.contributions) row.push_back(shown_share(part));
    rows.push_back(std::move(row));
  }
  print(format_table(rows));
  if (answer.ranking.size() > kMostRows) {
    print_line("and " + std::to_string(answer.ranking.size() - kMostRows) + " more: --json has all");
  }
  print_line("\n" + sensitivity_text(answer));
}

int run_rank(const Arguments& arguments) {
  const auto answer = rank_file(arguments.words[0]);
  if (!answer) return print_error(arguments, answer.error());
  if (arguments.has("--json")) {
    print_json(ranking_value(*answer));
  } else {
    print_weights(*answer);
    print_ranking(*answer);
  }
  return kGood;
}

const std::vector<Command> kRankCommands = {
    {{"rank"},
     {"rank FILE|-",
      "Ranks alternatives by criteria (the analytic hierarchy process), and says why. Needs no node.\n"
      "The file has the goal, a tree of criteria, judgments in pairs, and the alternatives with their values:\n"
      "config/rank/README.md. Judgments that contradict each other (consistency ratio over 0.10) are refused:\n"
      "exit 1, with the one that hurts most and the number that would fit.",
      {"--json|for programs: criteria, consistency, ranking, sensitivity"},
      {"trb rank config/rank/paper-figure-8.json", "trb rank - --json < problem.json"},
      1,
      1},
     run_rank}};

}  // namespace

std::vector<Command> rank_commands() {
  return kRankCommands;
}

}  // namespace trb::cli
