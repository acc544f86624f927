#include "services/cli/commands/simulate_beside.hpp"

#include <utility>

#include "common/base/files.hpp"
#include "common/base/number_text.hpp"
#include "common/fleet/did_you_mean.hpp"
#include "common/simulation/job_beside.hpp"
#include "common/simulation/job_times.hpp"
#include "services/cli/commands/played_waits.hpp"
#include "services/cli/commands/scenario_check.hpp"
#include "services/cli/core/table.hpp"
#include "services/cli/io/print.hpp"

namespace trb::cli {
namespace {

constexpr const char* kOption = "--beside";

void add_fault(ConfigFaults& faults, std::string what, std::string hint) {
  faults.push_back({kOption, "", std::move(what), std::move(hint)});
}

void read_one(Beside& one, ConfigFaults& faults) {
  one.scenario = read_file_scenario(one.file, faults);
  const auto text = read_file(one.file);
  auto json = text ? parse_json(*text) : Result<Value>(text.error());
  if (json) one.json = std::move(*json);  // what is wrong with it is told already
}

std::size_t runs_of(const Value& answer) {
  const Value* beside = answer.find("beside");
  return 1 + (beside == nullptr ? 0 : beside->list().size());
}

/// A key of the run that stands beside the first one's `world`; nullptr: the answer has none.
const Value* told_of(const Value& answer, std::size_t run, const char* key) {
  return run == 0 ? answer.find(key) : run_of(answer, run).find(key);
}

constexpr double kCounted_s = 0.5;  ///< a hand-over is shorter

/// What waited for a robot that another run kept.
struct Kept {
  double seconds = 0;
  std::size_t tasks = 0;
};

Kept kept_of(const Value& waits) {
  Kept out;
  for (const Value& row : waits.list()) {
    const Value* kept_s = row.find("kept_s");
    if (kept_s == nullptr || kept_s->number() < kCounted_s) continue;
    out.seconds += kept_s->number();
    ++out.tasks;
  }
  return out;
}

std::string kept_text(const Kept& kept) {
  if (kept.tasks == 0) return "-";
  return seconds_text(kept.seconds) + " s in all, " + std::to_string(kept.tasks) +
         (kept.tasks == 1 ? " task" : " tasks");
}

std::string alone_text(const Value& alone_s) {
  return alone_s.is_number() ? seconds_text(alone_s.number()) + " s" : "not FINISHED";
}

std::string submitted_text(const Value& answer, std::size_t run) {
  const double at_s = run_of(answer, run).find("submitted_s")->number();
  return at_s > 0 ? seconds_text(at_s - run_of(answer, 0).find("submitted_s")->number()) + " s" : "not any more";
}

}  // namespace

const Value& run_of(const Value& answer, std::size_t run) {
  return run == 0 ? *answer.find("world") : answer.find("beside")->list()[run - 1];
}

Beside beside_of(const std::string& word) {
  const auto at = word.rfind('@');
  const auto seconds = at == std::string::npos ? std::nullopt : parse_number<double>(word.substr(at + 1));
  if (!seconds || file_exists(word)) return {.file = word, .after_s = 0, .scenario = {}, .json = {}};
  return {.file = word.substr(0, at), .after_s = *seconds, .scenario = {}, .json = {}};
}

std::vector<Beside> read_beside(const Arguments& arguments, ConfigFaults& faults) {
  std::vector<Beside> out;
  if (!arguments.has(kOption)) return out;
  const std::vector<std::string>& words = arguments.every.at(kOption);
  if (words.size() > simulation::kMostBeside) {
    add_fault(faults, std::to_string(words.size()) + " scenarios beside the first one",
              "play " + std::to_string(simulation::kMostBeside) + " at most");
    return out;
  }
  for (const std::string& word : words) {
    out.push_back(beside_of(word));
    Beside& one = out.back();
    if (!(one.after_s >= 0 && one.after_s <= simulation::kMaxUntil)) {
      add_fault(faults, in_quotes(word) + ": no time after the first run's submission", "write FILE@20: 0 to 604800 s");
    }
    read_one(one, faults);
  }
  return out;
}

Value beside_job(const std::vector<Beside>& beside) {
  Value::List out;
  for (const Beside& one : beside) {
    out.push_back(Value{Value::Object{{"scenario", one.json}, {"after", Value{one.after_s}}}});
  }
  return Value{std::move(out)};
}

void print_runs(const Value& answer) {
  const bool has_alone = answer.find("alone_s") != nullptr, has_waits = answer.find("waits") != nullptr;
  std::vector<std::string> head{"RUN", "SCENARIO", "SUBMITTED", "STATE", "TASKS", "MAKESPAN"};
  if (has_alone) head.emplace_back("ALONE");
  if (has_waits) head.emplace_back("WAITED FOR ROBOTS OF OTHER RUNS");
  std::vector<std::vector<std::string>> rows{std::move(head)};
  for (std::size_t run = 0; run < runs_of(answer); ++run) {
    const Value& is = run_of(answer, run);
    std::vector<std::string> row{std::to_string(run + 1),
                                 is.find("scenario")->text(),
                                 submitted_text(answer, run),
                                 is.find("state")->text(),
                                 std::to_string(is.find("tasks_done")->integer()),
                                 seconds_text(is.find("makespan_s")->number()) + " s"};
    if (has_alone) row.push_back(alone_text(*told_of(answer, run, "alone_s")));
    if (has_waits) row.push_back(kept_text(kept_of(*told_of(answer, run, "waits"))));
    rows.push_back(std::move(row));
  }
  print(format_table(rows));
}

}  // namespace trb::cli
