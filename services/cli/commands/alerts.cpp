// alert list, alert decide.
#include <algorithm>
#include <cstdio>
#include <cstdlib>

#include "common/operator/decide.hpp"
#include "common/transport/loop.hpp"
#include "services/cli/commands/command.hpp"
#include "services/cli/core/alert_words.hpp"
#include "services/cli/core/table.hpp"
#include "services/cli/io/print.hpp"
#include "services/cli/io/probe.hpp"

namespace trb::cli {
namespace {

constexpr std::size_t kShortId = 8;
constexpr std::size_t kMostShown = 10;

std::string shown(double number) {
  char out[32];
  std::snprintf(out, sizeof out, "%.3f", number);
  return out;
}

bool is_open(const Alert& alert) {
  return alert.state != AlertState::decided && alert.state != AlertState::closed;
}

// ---- list

void print_table(const AlertTable& table) {
  std::vector<std::vector<std::string>> rows{{"ALERT", "TIME", "STATE", "RUN", "ROBOT", "LOST", "SEVERITY", "TASKS"}};
  for (const Alert& alert : table.alerts) {
    rows.push_back({or_dash(alert.id.substr(0, kShortId)), to_iso8601({alert.time}), std::string(name_of(alert.state)),
                    alert.run.empty() ? "-" : alert.run.substr(0, kShortId) + " " + alert.name, or_dash(alert.robot),
                    lost_of(alert), alert.cause == "robot_wanted" ? "-" : std::string(name_of(alert.severity)),
                    joined(alert.tasks, ",")});
  }
  print(format_table(rows));
}

std::string takers_of(const Proposal& proposal) {
  if (!proposal.robot.empty()) return proposal.robot;
  std::string out;
  for (const TaskForRobot& one : proposal.tasks) out += (out.empty() ? "" : ", ") + one.robot + ": " + one.task;
  return out;
}

void print_proposals(const Alert& alert) {
  std::vector<std::vector<std::string>> rows{{"", "PROPOSAL", "SCORE", "MERIT", "BY", "NOTE"}};
  for (std::size_t i = 0; i < alert.proposals.size() && i < kMostShown; ++i) {
    const Proposal& one = alert.proposals[i];
    std::string parts;
    for (const CriterionPart& part : one.parts) parts += (parts.empty() ? "" : ", ") + part_text(one, part);
    rows.push_back(
        {std::to_string(i + 1), takers_of(one), shown(one.score), shown(one.merit), or_dash(parts), one.note});
  }
  if (rows.size() > 1) print(format_table(rows));
  if (alert.proposals.size() > kMostShown) {
    print_line("and " + std::to_string(alert.proposals.size() - kMostShown) + " more: --json has all");
  }
}

void print_open(const Alert& alert) {
  print_line("\n" + coloured(Colour::bad, alert.id.substr(0, kShortId)) + "  " + alert.robot +
             (alert.robot.empty() ? "" : ": ") + alert.cause + ": " + alert.text);
  if (alert.verdict != Verdict::none) {
    print_line("decided by " + (alert.person.empty() ? "the policy" : alert.person) + ": " +
               std::string(name_of(alert.verdict)) + (alert.reason.empty() ? "" : " (" + alert.reason + ")"));
  } else if (const std::string hold = hold_text(alert, read_clocks().utc); !hold.empty()) {
    print_line(hold);
  }
  print_proposals(alert);
  for (std::size_t i = 0; i < alert.unfit.size() && i < kMostShown; ++i) {
    print_line("not " + alert.unfit[i].robot + ": " + alert.unfit[i].why);
  }
  if (!alert.waits_for.empty()) print_line("waits for: " + alert.waits_for);
}

int run_alert_list(const Arguments& arguments) {
  auto probe = open_probe(arguments);
  if (!probe) return kFailed;
  auto table = probe->ask_node<AlertTable>(AlertListRequest{arguments.has("--all")});
  if (!table) return print_error(arguments, table.error());
  if (arguments.has("--json")) {
    print_line(to_json(*table));
    return kGood;
  }
  if (table->alerts.empty()) {
    print_line(arguments.has("--all") ? "no alerts" : "no open alerts; --all has those that are over");
    return kGood;
  }
  print_table(*table);
  for (const Alert& alert : table->alerts) {
    if (is_open(alert)) print_open(alert);
  }
  return kGood;
}

// ---- decide

std::string user() {
  const char* name = std::getenv("USER");
  return name == nullptr || *name == '\0' ? "somebody" : name;
}

/// "t4,t7"
std::vector<std::string> words_of(const std::string& list) {
  std::vector<std::string> out;
  for (std::size_t begin = 0; begin <= list.size();) {
    const std::size_t end = std::min(list.find(',', begin), list.size());
    if (end > begin) out.push_back(list.substr(begin, end - begin));
    begin = end + 1;
  }
  return out;
}

/// The verdict that an option gives; how many were given.
int take_verdict(const Arguments& arguments, AlertDecide& out) {
  int given = 0;
  const auto take = [&](const char* option, Verdict verdict) {
    if (!arguments.has(option)) return;
    out.verdict = verdict;
    ++given;
  };
  take("--robot", Verdict::accept);
  take("--override", Verdict::override_);
  take("--retry", Verdict::retry);
  take("--skip", Verdict::skip);
  take("--abort", Verdict::abort);
  // The best proposal is what one says yes to.
  if (given == 0 && !out.alert.empty()) out.verdict = Verdict::accept;
  return given;
}

Result<AlertDecide> decision_of(const Arguments& arguments) {
  AlertDecide out;
  if (!arguments.words.empty()) out.alert = arguments.words[0];
  out.run = arguments.get("--run");
  out.tasks = words_of(arguments.get("--task"));
  if (Status named = op::check_subject(out); !named) return named.error();
  if (arguments.has("--task") && out.tasks.empty()) return fail(Errc::bad_value, "--task names none", "--task T[,T]");
  if (take_verdict(arguments, out) > 1) {
    return fail(Errc::bad_value, "several verdicts", "one of --robot, --override, --retry, --skip and --abort");
  }
  out.robot = arguments.get("--robot", arguments.get("--override"));
  out.person = arguments.get("--person", user());
  out.reason = arguments.get("--reason");
  out.stands = arguments.has("--stands");
  if (Status sound = op::check_decision(out); !sound) return sound.error();
  return out;
}

int run_decide(const Arguments& arguments) {
  const auto decision = decision_of(arguments);
  if (!decision) {
    print_error(arguments, decision.error());
    return kWrongUse;
  }
  auto probe = open_probe(arguments);
  if (!probe) return kFailed;
  const auto ack =
      probe->wait<Ack>([&](op::Session& session, const auto& done) { op::decide(session, *decision, done); });
  if (!ack) return print_error(arguments, ack.error());
  print_line(arguments.has("--json") ? to_json(*ack) : ack->text);
  return kGood;
}

const std::string kDecidingNode = "--node DIR|the node that decides, the cloud's (else TRB_NODE, else this folder)";

const std::vector<Command> kAlertCommands = {
    {{"alert", "list"},
     {"alert list",
      "Lists what robots cannot do any more, who could take over and why in this order; behind them, without an id, "
      "the\n"
      "WARNING and URGENT faults of the last 15 minutes.",
      {"--all|those that are over as well", kDecidingNode, "--json|for programs: everything that is known of each"},
      {"trb alert list", "trb alert list --all --json"},
      0,
      0},
     run_alert_list},
    {{"alert", "decide"},
     {"alert decide [ALERT]",
      "Decides on an alert; without a verdict the best proposal is accepted. ALERT is a unique beginning of its id; "
      "with\n"
      "--run, it is decided on a run's tasks of which no alert tells. A robot that failed gives its tasks back "
      "before\n"
      "others get them; if it is silent, or nobody knows what became of a task, somebody must have seen that it "
      "stands.",
      {"--task T[,T]|only these of its tasks; the others come back as an alert of their own",
       "--run RUN|without an alert: move, retry or skip the tasks of --task, all of one robot",
       "--robot R|accept the proposal of this robot", "--override R|this robot, though it is not proposed",
       "--retry|the same robot tries again: it is repaired, and its node is told so; after a decision too",
       "--skip|what has failed is left out", "--abort|the run ends",
       "--stands|I have seen that the failed robot stands", "--reason TEXT|why; an override needs one",
       "--person NAME|who decides ($USER)", kDecidingNode, kJson},
      {"trb alert decide 3f2a", "trb alert decide 3f2a --robot pioneer2",
       "trb alert decide 3f2a --override turtlebot --reason 'it stands next to it' --stands",
       "trb alert decide --run 71c0 --task fetch,carry --robot pioneer1"},
      0,
      1},
     run_decide},
};

}  // namespace

std::vector<Command> alert_commands() {
  return kAlertCommands;
}

}  // namespace trb::cli
