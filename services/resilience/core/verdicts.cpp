// ResilienceCore: what people ask and decide.
#include <algorithm>

#include "proto/value.hpp"
#include "services/resilience/core/resilience_core.hpp"

namespace trb::resilience {
namespace {

constexpr Duration kShown = std::chrono::minutes(15);  ///< a lesser fault is shown for so long

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
  if (!body.alert.empty() && !body.run.empty()) {
    return refuse(fail(Errc::bad_value, "run: an alert names its run itself", "give the alert, or run and tasks"));
  }
  const bool by_run = body.alert.empty() && !body.run.empty();
  const auto alert = by_run ? Result<Alert*>(nullptr) : book_.choose(body.alert);
  if (!alert) return refuse(alert.error());
  const auto taken = by_run ? decide_tasks(body, now, out) : decide_alert(**alert, body, now, out);
  if (!taken) return refuse(taken.error());
  out.reply(from, Ack{"accepted", cut_utf8(*taken, 1024)});
}

Result<std::string> ResilienceCore::decide_alert(Alert& alert, const AlertDecide& body, Now now, Outbox& out) {
  if (alert.run.empty()) return decide_lone(alert, body, now, out);
  const bool undecided = alert.verdict == Verdict::none && is_open(alert);
  return undecided ? decide(alert, body, now, out) : decide_again(alert, body, now, out);
}

/// The fault of a robot that no run needs: a person can say that it is over.
Result<std::string> ResilienceCore::decide_lone(Alert& alert, const AlertDecide& body, Now now, Outbox& out) {
  if (!is_open(alert)) return fail(Errc::conflict, "alert " + alert.id + " is closed: " + alert.waits_for);
  if (body.verdict != Verdict::retry) {
    return fail(Errc::bad_value, "no run needs " + alert.robot + ": there is nothing to move or to skip",
                "say --retry once it works again");
  }
  if (settings_.role != Role::cloud && !told_broken(alert).empty()) {
    return fail(Errc::not_permitted, "this node puts no robot back into use",
                "say it on the cloud's node, or on the robot's: trb robot repaired " + alert.robot);
  }
  if (alert.state == AlertState::releasing) return "alert " + alert.id + " " + decided_text(alert) + " already";
  alert.verdict = body.verdict;
  alert.person = body.person;
  alert.reason = body.reason;
  alert.state = AlertState::releasing;
  mend(alert, "said by " + person_of(alert), now);
  out.record(alert);
  look_at_lone(alert, now, out);
  if (!is_open(alert)) return alert.robot + " is taken as mended";
  return "alert " + alert.id + " " + decided_text(alert) + "; waits for: " + alert.waits_for;
}

/// The open alert that tells of the fault, which has outlived this one.
Alert* ResilienceCore::alert_of_fault(const Alert& alert) {
  const std::vector<std::string> broken = told_broken(alert);
  for (Alert* other : book_.open()) {
    const auto tells = [&](const std::string& capability) { return tells_of(*other, capability); };
    if (other->robot == alert.robot && std::ranges::any_of(broken, tells)) return other;
  }
  return nullptr;
}

/// It was decided before, or its run has ended: said once more it does no harm, a word may be added, `retry` says that
/// the robot is mended.
Result<std::string> ResilienceCore::decide_again(Alert& alert, const AlertDecide& body, Now now, Outbox& out) {
  const std::string name = "alert " + alert.id + " ";
  if (body.verdict == Verdict::retry && !is_open(alert) && !alert.robot.empty()) {
    mend(alert, "said by '" + body.person + "'", now);
    if (const auto broken = told_broken(alert); !broken.empty()) {
      Alert* stands = alert_of_fault(alert);
      if (stands == nullptr) stands = raise_lone({alert.robot, broken.front()}, now, out);
      if (stands == nullptr)
        return fail(Errc::queue_full, "too many alerts are open", "decide on some: trb alert list");
      if (stands->run.empty()) return decide_lone(*stands, body, now, out);
      return fail(Errc::conflict, name + "is closed: alert " + stands->id + " tells of the fault",
                  "decide on that one");
    }
    const bool decided = alert.verdict != Verdict::none;
    return alert.robot + " is taken as mended; " + name + (decided ? decided_text(alert) : "is closed");
  }
  const bool same = alert.verdict == body.verdict &&
                    (body.robot.empty() || alert.proposals.empty() || alert.proposals.front().robot == body.robot);
  if (alert.verdict == Verdict::none) return fail(Errc::conflict, name + "is closed: " + alert.waits_for);
  if (!same && is_stuck(alert, now)) return decide(alert, body, now, out);
  if (!same) return fail(Errc::conflict, name + decided_text(alert), "trb alert list --all has it");
  if (alert.state == AlertState::releasing && body.stands && !alert.needs_word) {
    alert.needs_word = true;
    out.record(alert);
    return name + decided_text(alert) + "; the word that " + alert.robot + " stands is taken";
  }
  return name + decided_text(alert) + " already";
}

Result<std::string> ResilienceCore::decide(Alert& alert, const AlertDecide& body, Now now, Outbox& out) {
  const WatchedRun* run = watcher_.find(alert.run);
  if (Status may = check_decider(alert, run, body); !may) return may.error();
  Alert next = alert;
  if (alert.state == AlertState::releasing) next.proposals.clear();  // decided anew
  if (Status good = shape(next, body, *run, now); !good) return good.error();
  alert = std::move(next);
  works_.erase(alert.id);
  works_[alert.id].releasing_since = now.mono;
  if (body.verdict == Verdict::retry) mend(alert, "said by " + person_of(alert), now);
  out.record(alert);
  out.log(LogLevel::warning, "alert_decided", alert.id + " " + decided_text(alert));
  stirred_ = true;
  due_runs_.notify(alert.run);  // what the verdict leaves out may be an alert of its own
  advance(alert, now, out);
  return "alert " + alert.id + " " + decided_text(alert) + "; waits for: " + alert.waits_for;
}

}  // namespace trb::resilience
