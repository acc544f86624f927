// ResilienceCore: from a verdict to the decision that the scheduler has.
#include <algorithm>

#include "common/security/keys.hpp"
#include "proto/value.hpp"
#include "services/resilience/core/plan.hpp"
#include "services/resilience/core/resilience_core.hpp"

namespace trb::resilience {

namespace {

/// So long a robot that can be reached is asked, though a person says that it stands: its result may be on its way.
constexpr Duration kAskedFirst = std::chrono::seconds(5);
constexpr Duration kStuck = std::chrono::seconds(30);  ///< so long whoever is waited for has the first word
constexpr const char* kStuckCure =
    "; it has been waited for for 30 s: --stands if you have seen that it stands, or another verdict";

}  // namespace

/// What was decided waits for long, and nothing is signed yet: it may be decided anew.
bool ResilienceCore::is_stuck(const Alert& alert, Now now) {
  const auto at = works_.find(alert.id);
  if (alert.state != AlertState::releasing || at == works_.end()) return false;
  const Work& work = at->second;
  return !work.record && work.signing.empty() && work.releasing_since && now.mono - *work.releasing_since >= kStuck;
}

void ResilienceCore::advance(Alert& alert, Now now, Outbox& out) {
  const WatchedRun* run = watcher_.find(alert.run);
  if (run == nullptr) {
    if (!watcher_.has_table()) return;
    // The order to abort, or a decision, was taken before the run ended.
    const bool handed = alert.verdict == Verdict::abort || works_[alert.id].hand.next().has_value();
    return handed ? finish(alert, out) : close(alert, run_over_text(alert.run), out);
  }
  if (!run->is_known()) {
    alert.waits_for = "the own scheduler's word on the run";
  } else if (alert.verdict == Verdict::abort) {
    advance_abort(alert, *run, now, out);
  } else if (alert.verdict == Verdict::retry && !works_[alert.id].record && waits_for_mending(alert, now, out)) {
    return;
  } else if (works_[alert.id].record) {
    hand_on(alert, *run, now, out);
  } else {
    advance_decision(alert, *run, now, out);
  }
}

void ResilienceCore::advance_abort(Alert& alert, const WatchedRun& run, Now now, Outbox& out) {
  Work& work = works_[alert.id];
  alert.waits_for = "the run's end";
  if (!work.refusal.empty()) return reopen(alert, "the order to abort was refused: " + work.refusal, out);
  if (work.record) {
    if (take_turn(alert.id, now)) out.command(settings_.node, RunAbort{*work.record}, 0);
    return;
  }
  if (work.signing.empty()) {
    const std::string reason = alert.reason.empty() ? "alert " + alert.id : alert.reason;
    work.signing = encode(AbortOrder{run.summary.run, settings_.node, cut_utf8(reason, 255), now.utc.ns});
  }
  if (!work.sign.due(now.mono)) return;
  work.sign.said(now.mono);
  out.request(settings_.node, SignRequest{std::string(kSignedRunAbort), {work.signing}});
}

/// Another alert's decision on the same run comes first: each is the next epoch.
std::string ResilienceCore::busy_with(const Alert& alert) {
  for (const Alert* other : book_.open()) {
    if (other->run != alert.run || other->id == alert.id) continue;
    const auto at = works_.find(other->id);
    if (at != works_.end() && (at->second.record || !at->second.signing.empty())) return other->id;
  }
  return {};
}

void ResilienceCore::advance_decision(Alert& alert, const WatchedRun& run, Now now, Outbox& out) {
  Work& work = works_[alert.id];
  const bool asked_long = work.releasing_since && now.mono - *work.releasing_since >= kAskedFirst;
  Plan plan = plan_of(alert, run, fleet_, settings_.node, asked_long);
  if (plan.rulings.empty()) {
    work.signing.clear();
    return close(alert, "nothing is left of it to decide", out);
  }
  if (!work.releasing_since) work.releasing_since = now.mono;
  alert.waits_for = cut_utf8(plan.waits_for, 380);
  if (!plan.waits_for.empty() && is_stuck(alert, now)) alert.waits_for += kStuckCure;
  if (!plan.release.empty() && work.release.due(now.mono)) {
    work.release.said(now.mono);
    out.command(alert.robot, ReleaseTasks{run.summary.run, run.view->epoch, plan.release}, 0);
  }
  if (!plan.waits_for.empty()) return work.signing.clear();
  if (const std::string other = busy_with(alert); !other.empty()) {
    alert.waits_for = "the decision on alert " + other;
  } else if (!run.is_current()) {
    alert.waits_for = "the run's definition";
  } else {
    begin_signing(alert, run, std::move(plan.rulings), now, out);
  }
}

void ResilienceCore::begin_signing(Alert& alert, const WatchedRun& run, std::vector<TaskRuling> rulings, Now now,
                                   Outbox& out) {
  Work& work = works_[alert.id];
  alert.waits_for = "the router's signature";
  Decision decision;
  decision.run = run.summary.run;
  decision.digest = run.start->digest;
  decision.epoch = run.view->epoch + 1;
  if (decision.epoch > 2) decision.previous.bytes = digest(run.last_decision);
  decision.by = settings_.node;
  decision.alert = alert.id;
  decision.person = alert.person;
  decision.reason = alert.reason;
  decision.time = now.utc.ns;
  for (const TaskRuling& ruling : rulings) {
    if (ruling.ruling != Ruling::move) continue;
    const RobotRecord* robot = fleet_.find(ruling.robot);
    if (alert.verdict == Verdict::accept && (robot == nullptr || !is_fit(*robot))) {
      return reopen(alert, ruling.robot + " cannot take over any more", out);
    }
    const bool listed = std::ranges::find(decision.members, ruling.robot, &Member::id) != decision.members.end();
    if (listed || run.is_member(ruling.robot)) continue;
    const auto certificate = certificates_.find(ruling.robot);
    if (certificate == certificates_.end()) {
      alert.waits_for = "the certificate of " + ruling.robot;
      return ask_routes(now, std::chrono::seconds(1));
    }
    decision.members.push_back({ruling.robot, certificate->second});
  }
  decision.tasks = std::move(rulings);
  if (const auto asked = decode<Decision>(work.signing); asked && !work.signing.empty()) decision.time = asked->time;
  work.signing = encode(decision);
  work.epoch = decision.epoch;
  if (!work.sign.due(now.mono)) return;
  work.sign.said(now.mono);
  out.request(settings_.node, SignRequest{std::string(kSignedDecision), {work.signing}});
}

void ResilienceCore::on_signed(const SignedRecord& record, Outbox& out) {
  for (Alert* alert : book_.open()) {
    const auto at = works_.find(alert->id);
    if (at == works_.end() || at->second.signing.empty() || at->second.signing != record.payload.bytes) continue;
    Work& work = at->second;
    work.record = record;
    work.signing.clear();
    stirred_ = true;
    if (record.kind != kSignedDecision) return;
    alert->epoch = work.epoch;
    out.record(RunDecision{record});
    out.record(*alert);
    return;
  }
  out.count("late.signed_record");
}

void ResilienceCore::hand_on(Alert& alert, const WatchedRun& run, Now now, Outbox& out) {
  Work& work = works_[alert.id];
  alert.waits_for = "the own scheduler to take the decision";
  for (const DecisionView& one : run.view->decisions) {
    if (one.epoch != work.epoch) continue;
    if (one.alert == alert.id) return finish(alert, out);
    return reopen(alert, "epoch " + std::to_string(one.epoch) + " of its run is another decision", out);
  }
  if (run.view->epoch >= work.epoch) return reopen(alert, "its run has come to another epoch", out);
  if (!work.refusal.empty()) return reopen(alert, "its decision was refused: " + work.refusal, out);
  if (take_turn(alert.id, now)) out.command(settings_.node, RunDecision{*work.record}, 0);
}

/// True if it is the alert's turn to hand its record on. One at a time: an answer names no run.
bool ResilienceCore::take_turn(const std::string& alert, Now now) {
  const auto other = works_.find(handed_);
  const bool busy = handed_ != alert && other != works_.end() && other->second.record && other->second.hand.next() &&
                    !other->second.hand.due(now.mono);
  Backoff& hand = works_[alert].hand;
  if (busy || !hand.due(now.mono)) return false;
  hand.said(now.mono);
  handed_ = alert;
  return true;
}

/// What has become of the alert's decision, if one was signed.
void ResilienceCore::record_handed(const Alert& alert, const std::string& what, Outbox& out) const {
  if (alert.epoch == 0) return;
  JournalDelivered fact;
  fact.run = alert.run;
  fact.to = settings_.node;
  fact.what = what;
  fact.epoch = alert.epoch;
  out.record(fact);
}

/// The scheduler has it.
void ResilienceCore::finish(Alert& alert, Outbox& out) {
  record_handed(alert, "decision", out);
  alert.state = AlertState::decided;
  due_runs_.notify(alert.run);
  alert.waits_for.clear();
  works_.erase(alert.id);
  out.record(alert);
  out.log(LogLevel::info, "decision_taken",
          alert.id + ": run " + alert.run.substr(0, 8) + ", epoch " + std::to_string(alert.epoch));
}

/// What was decided cannot be: the alert is as before the verdict, and says why.
void ResilienceCore::reopen(Alert& alert, const std::string& why, Outbox& out) {
  record_handed(alert, "decision_dropped", out);
  out.log(LogLevel::warning, "alert_reopened", alert.id + ": " + why);
  const bool refused = works_[alert.id].record.has_value();
  alert.state = AlertState::open;
  alert.verdict = Verdict::none;
  alert.person.clear();
  alert.reason.clear();
  alert.epoch = 0;
  alert.text = cut_utf8(alert.text + "; " + why, 1024);
  alert.proposals.clear();
  works_[alert.id] = {};
  // The policy is not to try the same again and again.
  if (refused) works_[alert.id].asks_for = why;
  if (const WatchedRun* run = watcher_.find(alert.run); run != nullptr && run->is_known()) {
    due_runs_.notify(alert.run);  // it is proposed for anew
    watcher_.refresh(alert.run);
  }
  out.record(alert);
}

}  // namespace trb::resilience
