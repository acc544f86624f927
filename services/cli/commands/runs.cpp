// run list, run show.
#include "services/cli/commands/runs.hpp"

#include <algorithm>
#include <iterator>

#include "common/base/files.hpp"
#include "common/operator/list_runs.hpp"
#include "common/operator/record_facts.hpp"
#include "common/operator/run_records.hpp"
#include "common/scenario/run_proof.hpp"
#include "common/scenario/run_proof_file.hpp"
#include "common/security/node_keys.hpp"
#include "services/cli/commands/authority_words.hpp"
#include "services/cli/commands/command.hpp"
#include "services/cli/core/table.hpp"
#include "services/cli/core/task_words.hpp"
#include "services/cli/io/print.hpp"
#include "services/cli/io/probe.hpp"

namespace trb::cli {
namespace {

constexpr std::size_t kMaxProof = 64U << 20U;

std::vector<std::vector<std::string>> run_rows(const RunTable& table) {
  std::vector<std::vector<std::string>> rows{
      {"RUN", "NAME", "STATE", "TASKS", "PRIORITY", "SINCE", "ARCHIVED", "WAITS FOR"}};
  for (const RunSummary& run : table.runs) {
    rows.push_back({run.run.substr(0, 8), run.name, std::string(name_of(run.state)),
                    std::to_string(run.tasks_final) + "/" + std::to_string(run.tasks), std::to_string(run.priority),
                    to_iso8601({run.created}), time_or_dash(run.over), run.waits_for});
  }
  return rows;
}

/// `records`: as far as they were read.
void print_tasks(const RunView& view, const RunRecords& records) {
  std::vector<std::vector<std::string>> rows{{"TASK", "ROBOT", "SKILL", "STATE", "ATTEMPT", "BEGAN", "TOOK", "WHY"}};
  for (const TaskView& task : view.tasks) {
    const std::vector<TaskResult> doers = op::doers_of(records, task.id);
    rows.push_back({task.id, robot_of(task, doers), task.skill, state_word(task), std::to_string(task.attempt),
                    time_or_dash(task.started), task.ended == 0 ? "-" : took_text(task.duration_s),
                    why_of(task, doers)});
  }
  print(format_table(rows));
  for (const TaskView& task : view.tasks) {
    if (!task.data.empty()) print_line("result of " + task.id + ": " + task.data);
  }
}

void print_decisions(const RunView& view) {
  for (const DecisionView& one : view.decisions) {
    print_line("epoch " + std::to_string(one.epoch) + ", " + to_iso8601({one.time}) + ", by " +
               (one.person.empty() ? "the policy" : one.person) + " at " + one.by +
               (one.reason.empty() ? "" : ": " + one.reason));
    for (const TaskRuling& ruling : one.tasks) {
      print_line("  " + ruling.task + ": " + std::string(name_of(ruling.ruling)) +
                 (ruling.robot.empty() ? "" : " -> " + ruling.robot));
    }
  }
}

bool has_ended(const RunView& view) {
  return view.over != 0 || view.state == RunState::finished || view.state == RunState::aborted ||
         view.state == RunState::expired;
}

/// When the last of its tasks has ended, by that robot's clock. A run that is over is archived only a minute later.
std::string end_of(const RunView& view) {
  std::int64_t ended = 0;
  for (const TaskView& task : view.tasks) ended = std::max(ended, task.ended);
  return (ended == 0 ? "" : ", last task ended " + to_iso8601({ended})) +
         (view.over == 0 ? "" : ", archived " + to_iso8601({view.over}));
}

void print_view(const RunView& view, const RunRecords& records) {
  print_line("run " + view.run + " '" + view.name + "': " + std::string(name_of(view.state)) +
             (has_ended(view) ? end_of(view) : ""));
  print_line("submitted by " + view.submitter + " " + to_iso8601({view.created}) + ", priority " +
             std::to_string(view.priority) + ", epoch " + std::to_string(view.epoch));
  if (!has_ended(view) && view.left_s > 0) print_line("nothing of it begins later than in " + took_text(view.left_s));
  if (const auto ender = op::ender_of(records)) {
    print_line("ended by " + ender->node + " " + to_iso8601(ender->time) +
               (ender->reason.empty() ? "" : ": " + ender->reason));
  }
  if (!view.paused_by.empty()) print_line("held by " + view.paused_by);
  if (!view.waits_for.empty()) print_line("waits for: " + view.waits_for);
  print_tasks(view, records);
  print_decisions(view);
}

Result<RunRecords> read_records(Probe& probe, const std::string& run) {
  return probe.wait<RunRecords>(
      [&](op::Session& session, const auto& done) { op::read_run_records(session, run, done); });
}

/// What its records say besides: "ended_by", and who did what was done twice.
Value::Object facts_json(const RunView& view, const RunRecords& records) {
  Value::Object out;
  if (const auto ender = op::ender_of(records)) {
    out.emplace_back("ended_by", Value{Value::Object{{"node", Value{ender->node}},
                                                     {"reason", Value{ender->reason}},
                                                     {"time", Value{ender->time.ns}}}});
  }
  Value::List twice;
  for (const TaskView& task : view.tasks) {
    const std::vector<TaskResult> doers = op::doers_of(records, task.id);
    if (doers.size() < 2) continue;
    for (const TaskResult& one : doers) {
      twice.push_back(Value{Value::Object{{"task", Value{task.id}},
                                          {"robot", Value{one.robot}},
                                          {"attempt", Value{static_cast<std::int64_t>(one.key.attempt)}},
                                          {"started", Value{one.started}},
                                          {"ended", Value{one.ended}},
                                          {"duration_s", Value{one.duration_s}}}});
    }
  }
  if (!twice.empty()) out.emplace_back("done_twice", Value{std::move(twice)});
  return out;
}

void print_view_json(const RunView& view, const RunRecords& records) {
  Value::Object facts = facts_json(view, records);
  const std::string plain = to_json(view);
  auto json =
      facts.empty() ? Result<Value>(Value()) : parse_json(plain, {.bytes = plain.size(), .values = plain.size()});
  if (facts.empty() || !json) return print_line(plain);
  auto& members = std::get<Value::Object>(json->is);
  members.insert(members.end(), std::make_move_iterator(facts.begin()), std::make_move_iterator(facts.end()));
  print_json(*json);
}

int show_run(const Arguments& arguments) {
  auto probe = open_probe(arguments);
  if (!probe) return kFailed;
  auto view = probe->ask_node<RunView>(RunQuery{arguments.words[0]});
  if (!view) return print_error(arguments, view.error());
  // Without them the run is shown all the same: they have made room, or are too large to be read.
  const auto records = op::needs_records(*view) ? read_records(*probe, view->run) : Result<RunRecords>(RunRecords());
  if (arguments.has("--json")) {
    print_view_json(*view, records ? *records : RunRecords());
  } else {
    print_view(*view, records ? *records : RunRecords());
  }
  return kGood;
}

int prove_run(const Arguments& arguments) {
  auto probe = open_probe(arguments);
  if (!probe) return kFailed;
  const auto keys = load_node_certificate(".");  // the probe stands in the node's folder
  if (!keys) return print_error(arguments, keys.error());
  const auto read = read_records(*probe, arguments.words[0]);
  if (!read) return print_error(arguments, read.error());
  print_line(write_run_proof(read->run, read->records, keys->authority));
  return kGood;
}

void print_proof(const RunProof& proof) {
  std::vector<std::vector<std::string>> rows{{"TIME", "SIGNED BY", "RECORD", "SAYS"}};
  for (const ProvenRecord& record : proof.records) {
    rows.push_back({time_or_dash(record.time.ns), record.signer, record.kind, record.what});
  }
  print(format_table(rows));
  for (const std::string& fault : proof.faults) print_line(coloured(Colour::bad, "FAULT " + fault));
  print_line("run " + or_dash(proof.run) + ": " + std::to_string(proof.records.size()) + " records proven, " +
             std::to_string(proof.final_tasks) + " of " + std::to_string(proof.tasks) + " tasks with a final result, " +
             (proof.has_ended ? "its end is signed" : "no signed end"));
}

Value to_value(const ProvenRecord& record) {
  return Value{Value::Object{{"time", Value{time_or_dash(record.time.ns)}},
                             {"signer", Value{record.signer}},
                             {"kind", Value{record.kind}},
                             {"what", Value{record.what}}}};
}

void print_proof_json(const RunProof& proof) {
  Value::List records;
  for (const ProvenRecord& record : proof.records) records.push_back(to_value(record));
  Value::List faults;
  for (const std::string& fault : proof.faults) faults.push_back(Value{fault});
  print_json(Value{Value::Object{{"run", Value{proof.run}},
                                 {"complete", Value{proof.is_complete()}},
                                 {"tasks", Value{static_cast<std::int64_t>(proof.tasks)}},
                                 {"final_tasks", Value{static_cast<std::int64_t>(proof.final_tasks)}},
                                 {"ended", Value{proof.has_ended}},
                                 {"records", Value{std::move(records)}},
                                 {"faults", Value{std::move(faults)}}}});
}

int verify_run(const Arguments& arguments) {
  init_crypto();
  const auto authority = authority_of(arguments);
  if (!authority) return print_error(arguments, authority.error());
  const auto text = read_file(arguments.words[0], kMaxProof);
  if (!text) return print_error(arguments, text.error());
  const auto records = read_run_proof(*text);
  if (!records) return print_error(arguments, records.error());
  const RunProof proof = check_run_proof(*records, *authority);
  arguments.has("--json") ? print_proof_json(proof) : print_proof(proof);
  return proof.faults.empty() ? kGood : kFailed;
}

}  // namespace

int list_runs(const Arguments& arguments) {
  auto probe = open_probe(arguments);
  if (!probe) return kFailed;
  const auto table = probe->wait<RunTable>(
      [&](op::Session& session, const auto& done) { op::list_runs(session, arguments.has("--all"), done); });
  if (!table) return print_error(arguments, table.error());
  if (arguments.has("--json")) {
    print_line(to_json(*table));
    return kGood;
  }
  print(format_table(run_rows(*table)));
  if (table->more) print_line("there are more; trb run show RUN knows each");
  return kGood;
}

std::vector<Command> run_commands() {
  return {
      {{"run", "list"},
       {"run list",
        "The runs that are not over on this node; with --all also its archive, newest first. What is over is archived "
        "a "
        "minute later.",
        {"--all|those that are over as well", kAskedNode, kJson},
        {"trb run list", "trb run list --all --json"},
        0,
        0},
       list_runs},
      {{"run", "show"},
       {"run show RUN",
        "A run whole, also one that is over: its tasks, who did them, in which attempt, why not, their results, and "
        "what "
        "was decided.\nRUN is a unique beginning of its id.",
        {kAskedNode, kJson},
        {"trb run show 3f2a", "trb run show 3f2a --json"},
        1,
        1},
       show_run},
      {{"run", "proof"},
       {"run proof RUN",
        "What is signed of a run, as a file for a third party: its start, decisions, results, its end. Also of a run "
        "that\nis over. trb run verify checks it.",
        {kAskedNode},
        {"trb run proof 3f2a > run.json"},
        1,
        1},
       prove_run},
      {{"run", "verify"},
       {"run verify FILE",
        "Shows who ordered, who decided and who did what in a run, to anybody who has the fleet's public key. FILE is "
        "of\ntrb run proof, or of the gateway's GET /api/v1/runs/RUN/proof. Exit status 0: every record is proven; 1: "
        "one is not,\nand it says which.",
        {"--fleet FLEET_DIR|the fleet's public half, fleet.json", "--key HEX|the authority's public key instead",
         kJson},
        {"trb run verify run.json --fleet ~/hall-3-authority"},
        1,
        1},
       verify_run},
  };
}

}  // namespace trb::cli
