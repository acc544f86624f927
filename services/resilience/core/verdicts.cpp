// ResilienceCore: what people ask and decide.
#include <algorithm>

#include "proto/value.hpp"
#include "services/resilience/core/resilience_core.hpp"

namespace trb::resilience {
namespace {

constexpr Duration kShown = std::chrono::minutes(15);  ///< a lesser fault is shown for so long
constexpr const char* kStands = "say --stands if you have seen that it stands";

std::string person_of(const Alert& alert) {
  return alert.person.empty() ? "the policy" : "'" + alert.person + "'";
}

/// "was decided by 'ann': accept, drive to pioneer1"
std::string decided_text(const Alert& alert) {
  const std::string verdict(name_of(alert.verdict));
  std::string out = "was decided by " + person_of(alert) + ": " + verdict;
  const bool moves = alert.verdict == Verdict::accept || alert.verdict == Verdict::override_;
  if (!moves || alert.proposals.empty()) return out;
  for (const TaskForRobot& one : alert.proposals.front().tasks) out += ", " + one.task + " to " + one.robot;
  return cut_utf8(out, 512);
}

/// The proposal that the word means: one robot's, or the one of several; the best if none is named.
std::vector<Proposal>::iterator find_proposal(Alert& alert, const std::string& robot) {
  if (robot.empty()) return alert.proposals.begin();
  return std::ranges::find(alert.proposals, robot, &Proposal::robot);
}

std::string names_of(const std::vector<Proposal>& proposals) {
  std::string out;
  for (const Proposal& one : proposals) out += (out.empty() ? "" : ", ") + one.robot;
  return out;
}

}  // namespace

void ResilienceCore::handle(const AlertListRequest& body, const Inbound& from, Now now, Outbox& out) {
  for (Alert* alert : book_.open()) {
    const WatchedRun* run = watcher_.find(alert->run);
    // Nobody holds what was proposed long ago.
    if (alert->state == AlertState::expired && run != nullptr && run->is_known()) propose(*alert, *run, now);
  }
  AlertTable table = book_.table(body.all);
  for (Alert& lesser : lesser_faults(fleet_, now.utc - kShown)) {
    if (table.alerts.size() == AlertBook::kMaxTable) break;
    table.alerts.push_back(std::move(lesser));
  }
  out.reply(from, std::move(table));
}

void ResilienceCore::handle(const AlertDecide& body, const Inbound& from, Now now, Outbox& out) {
  const auto refuse = [&](const Error& error) {
    out.count("refused.alert_decide." + std::string(errc_name(error.code)));
    out.nack(from, error);
  };
  if (from.source != settings_.node) {
    return refuse(fail(Errc::not_permitted, "an alert is decided on the node whose alert it is", "use --node"));
  }
  const auto alert = book_.choose(body.alert);
  if (!alert) return refuse(alert.error());
  const auto taken = (*alert)->run.empty()                                    ? decide_lone(**alert, body, now, out)
                     : (*alert)->verdict == Verdict::none && is_open(**alert) ? decide(**alert, body, now, out)
                                                                              : decide_again(**alert, body, now, out);
  if (!taken) return refuse(taken.error());
  out.reply(from, Ack{"accepted", cut_utf8(*taken, 1024)});
}

/// The fault of a robot that no run needs: a person can say that it is over.
Result<std::string> ResilienceCore::decide_lone(Alert& alert, const AlertDecide& body, Now now, Outbox& out) {
  if (!is_open(alert)) return fail(Errc::conflict, "alert " + alert.id + " is closed");
  if (body.verdict != Verdict::retry) {
    return fail(Errc::bad_value, "no run needs " + alert.robot + ": there is nothing to move or to skip",
                "say --retry once it works again");
  }
  alert.verdict = body.verdict;
  alert.person = body.person;
  alert.reason = body.reason;
  mend(alert, "said by " + person_of(alert), now);
  close(alert, "taken as mended", out);
  return alert.robot + " is taken as mended";
}

/// It was decided before, or its run has ended: said once more it does no harm, a word may be added, `retry` says that
/// the robot is mended.
Result<std::string> ResilienceCore::decide_again(Alert& alert, const AlertDecide& body, Now now, Outbox& out) {
  const std::string name = "alert " + alert.id + " ";
  if (body.verdict == Verdict::retry && !is_open(alert) && !alert.robot.empty()) {
    mend(alert, "said by '" + body.person + "'", now);
    const bool decided = alert.verdict != Verdict::none;
    return alert.robot + " is taken as mended; " + name + (decided ? decided_text(alert) : "is closed");
  }
  const bool same = alert.verdict == body.verdict &&
                    (body.robot.empty() || alert.proposals.empty() || alert.proposals.front().robot == body.robot);
  if (alert.verdict == Verdict::none) return fail(Errc::conflict, name + "is closed: " + alert.waits_for);
  if (!same) return fail(Errc::conflict, name + decided_text(alert), "trb alert list --all has it");
  if (alert.state == AlertState::releasing && body.stands && !alert.needs_word) {
    alert.needs_word = true;
    out.record(alert);
    return name + decided_text(alert) + "; the word that " + alert.robot + " stands is taken";
  }
  return name + decided_text(alert) + " already";
}

Status ResilienceCore::check_taker(Alert& alert, const AlertDecide& body, const WatchedRun& run, Now now) {
  if (body.verdict == Verdict::accept) {
    if (alert.proposals.empty() || alert.state == AlertState::expired || is_stale(alert)) propose(alert, run, now);
    if (alert.proposals.empty()) {
      return fail(Errc::conflict, "no robot can take over", "trb alert list says why; --retry, --skip or --abort");
    }
    if (find_proposal(alert, body.robot) != alert.proposals.end()) return Done{};
    return fail(Errc::bad_value, "'" + body.robot + "' is not proposed",
                "use one of " + names_of(alert.proposals) + ", or --override with a reason");
  }
  if (body.robot.empty() || body.reason.empty()) {
    return fail(Errc::missing, "an override needs a robot and a reason", "--override ROBOT --reason TEXT");
  }
  const RobotRecord* robot = fleet_.find(body.robot);
  if (robot == nullptr) return fail(Errc::unknown_target, "'" + body.robot + "' was never heard", "trb robot list");
  if (body.robot == alert.robot) return fail(Errc::bad_value, "it is the robot that failed", "use --retry");
  std::vector<std::size_t> tasks;
  for (const std::string& id : alert.tasks) {
    const auto index = run.find_task(id);
    if (!index) continue;
    if (run.start->scenario.tasks[*index].pinned && !wants_robot(alert)) {
      return fail(Errc::conflict, "task '" + id + "' is pinned to " + alert.robot, "use --retry, --skip or --abort");
    }
    tasks.push_back(*index);
  }
  const auto needs = needs_of(run, tasks, alert.robot);
  if (!needs) return needs.error();
  for (const TaskNeed& need : needs->tasks) {
    const std::string why = why_unable(*robot, need);
    if (!why.empty()) return fail(Errc::bad_value, "'" + body.robot + "' cannot do task '" + need.task + "': " + why);
  }
  return Done{};
}

Status ResilienceCore::check_word(const Alert& alert, const AlertDecide& body, const WatchedRun& run) const {
  if (body.stands || body.verdict == Verdict::abort) return Done{};
  for (const std::string& id : alert.tasks) {
    const auto index = run.find_task(id);
    if (!index) continue;
    const std::string why = why_word(run, *index, fleet_, body.verdict == Verdict::retry);
    if (!why.empty()) return fail(Errc::bad_value, why, kStands);
  }
  return Done{};
}

Status ResilienceCore::check_retry(const Alert& alert, Now now) const {
  if (wants_robot(alert)) return fail(Errc::bad_value, "nothing has failed: there is nothing to try again");
  const Presence::Gone* gone = presence_.find(alert.robot, now);
  if (gone == nullptr) return Done{};
  return fail(Errc::conflict, alert.robot + " cannot try again: " + gone->text, "bring it back, or let another one");
}

Result<std::string> ResilienceCore::decide(Alert& alert, const AlertDecide& body, Now now, Outbox& out) {
  const WatchedRun* run = watcher_.find(alert.run);
  if (run == nullptr || !run->is_known() || !routes_heard_) {
    return fail(Errc::unknown_run, "run " + alert.run + " is not known by this node's scheduler now", "try again");
  }
  if (!decides(alert)) {
    const std::string who = run->decider();
    return fail(Errc::not_permitted, "this node does not decide on run " + alert.run,
                who.empty() ? "the run has no cloud node: abort it" : "say it on node '" + who + "'");
  }
  if (body.verdict == Verdict::none) {
    return fail(Errc::missing, "no verdict", "--robot, --override, --retry, --skip or --abort");
  }
  const bool moves = body.verdict == Verdict::accept || body.verdict == Verdict::override_;
  Status good = moves ? check_taker(alert, body, *run, now) : Status(Done{});
  if (good && body.verdict == Verdict::retry) good = check_retry(alert, now);
  if (good) good = check_word(alert, body, *run);
  if (!good) return good.error();
  if (body.verdict == Verdict::accept) {
    const auto chosen = find_proposal(alert, body.robot);
    std::rotate(alert.proposals.begin(), chosen, chosen + 1);
  } else if (body.verdict == Verdict::override_) {
    Proposal own{body.robot, {}, 0, {}, cut_utf8("override: " + body.reason, 512)};
    for (const std::string& task : alert.tasks) own.tasks.push_back({task, body.robot});
    alert.proposals.insert(alert.proposals.begin(), std::move(own));
    if (alert.proposals.size() > kMaxProposals) alert.proposals.resize(kMaxProposals);
  }
  alert.verdict = body.verdict;
  alert.person = body.person;
  alert.reason = body.reason;
  // From here on it says that a person has given the word.
  alert.needs_word = body.stands;
  alert.state = AlertState::releasing;
  works_.erase(alert.id);
  if (body.verdict == Verdict::retry) mend(alert, "said by " + person_of(alert), now);
  out.record(alert);
  out.log(LogLevel::warning, "alert_decided", alert.id + " " + decided_text(alert));
  stirred_ = true;
  advance(alert, now, out);
  return "alert " + alert.id + " " + decided_text(alert) + "; waits for: " + alert.waits_for;
}

}  // namespace trb::resilience
