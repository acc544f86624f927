#include "services/resilience/core/decisions.hpp"

#include <algorithm>

#include "common/security/keys.hpp"
#include "proto/value.hpp"
#include "services/resilience/core/plan.hpp"
#include "services/resilience/core/run_over.hpp"

namespace trb::resilience {
namespace {

/// For this long a reachable robot is asked to stop, even if a person states that it stands: its result may be under
/// way, or it may move.
constexpr Duration kAskedFirst = std::chrono::seconds(5);
constexpr Duration kStuck = std::chrono::seconds(30);  ///< after this wait another verdict is allowed
constexpr const char* kStuckHint =
    "; it has been waited for for 30 s: --stands if you have seen that it stands, or another verdict";

/// The run's next epoch, without its rulings.
Decision decision_of(const Alert& alert, const WatchedRun& run, const std::string& node, Now now) {
  Decision out;
  out.run = run.summary.run;
  out.digest = run.start->digest;
  out.epoch = run.view->epoch + 1;
  if (out.epoch > 2) out.previous.bytes = digest(run.last_decision);
  out.by = node;
  out.alert = alert.id;
  out.person = alert.person;
  out.reason = alert.reason;
  out.time = now.utc.ns;
  return out;
}

}  // namespace

bool Decisions::is_stuck(const Alert& alert, Now now) const {
  const AlertWork* work = alerts_.find_work(alert.id);
  if (alert.state != AlertState::releasing || work == nullptr) return false;
  return !work->signing.is_under_way() && work->signing.has_waited(kStuck, now);
}

void Decisions::advance(Alert& alert, Now now, Outbox& out) {
  const WatchedRun* run = situation_.runs().find(alert.run);
  const Signing& signing = alerts_.work(alert.id).signing;
  if (run == nullptr) {
    if (!situation_.runs().has_table()) return;
    // The order to abort, or a decision, was accepted before the run ended.
    const bool handed = alert.verdict == Verdict::abort || signing.was_handed();
    return handed ? alerts_.finish(alert, out) : alerts_.close(alert, run_over_text(situation_.runs(), alert.run), out);
  }
  if (!run->is_known()) {
    alert.waits_for = "the own scheduler's word on the run";
  } else if (run->recovers() && alert.verdict != Verdict::abort) {
    alert.waits_for = recovery_text(*run);
  } else if (alert.verdict == Verdict::abort) {
    advance_abort(alert, *run, now, out);
  } else if (alert.verdict == Verdict::retry && !signing.record() && repairs_.is_awaited(alert, now, out)) {
    return;
  } else if (signing.record()) {
    hand_on(alert, *run, now, out);
  } else {
    advance_decision(alert, *run, now, out);
  }
}

void Decisions::advance_abort(Alert& alert, const WatchedRun& run, Now now, Outbox& out) {
  Signing& signing = alerts_.work(alert.id).signing;
  alert.waits_for = "the run's end";
  if (!signing.refusal().empty()) {
    return alerts_.reopen(alert, "the order to abort was refused: " + signing.refusal(), out);
  }
  if (signing.record()) {
    if (take_turn(alert.id, now)) out.command(situation_.node(), RunAbort{*signing.record()}, 0);
    return;
  }
  if (signing.payload().empty()) {
    const std::string reason = alert.reason.empty() ? "alert " + alert.id : alert.reason;
    signing.prepare(encode(AbortOrder{run.summary.run, situation_.node(), cut_utf8(reason, 255), now.utc.ns}), 0);
  }
  if (!signing.try_sign(now)) return;
  out.request(situation_.node(), SignRequest{std::string(kSignedRunAbort), {signing.payload()}});
}

/// The alert whose decision on the same run comes first, if any: each decision is the next epoch.
std::string Decisions::busy_with(const Alert& alert) {
  for (const Alert* other : alerts_.open()) {
    if (other->run != alert.run || other->id == alert.id) continue;
    const AlertWork* work = alerts_.find_work(other->id);
    if (work != nullptr && work->signing.is_under_way()) return other->id;
  }
  return {};
}

void Decisions::advance_decision(Alert& alert, const WatchedRun& run, Now now, Outbox& out) {
  Signing& signing = alerts_.work(alert.id).signing;
  const bool asked_long = signing.has_waited(kAskedFirst, now);
  Plan plan = plan_of(alert, run, situation_.fleet(), situation_.node(), asked_long);
  if (plan.rulings.empty()) return alerts_.close(alert, "nothing is left of it to decide", out);
  signing.begin(now);
  alert.waits_for = cut_utf8(plan.waits_for, 380);
  if (!plan.waits_for.empty() && is_stuck(alert, now)) alert.waits_for += kStuckHint;
  if (!plan.release.empty() && signing.try_release(now)) {
    out.command(alert.robot, ReleaseTasks{run.summary.run, run.view->epoch, plan.release, alert.needs_word}, 0);
  }
  if (!plan.waits_for.empty()) return signing.drop_payload();
  if (const std::string other = busy_with(alert); !other.empty()) {
    alert.waits_for = "the decision on alert " + other;
  } else if (!run.is_current()) {
    alert.waits_for = "the run's definition";
  } else {
    sign(alert, run, std::move(plan.rulings), now, out);
  }
}

/// Adds the robots that the decision brings into the run. False: one of them cannot be added, now or at all.
bool Decisions::add_members(Decision& decision, Alert& alert, const WatchedRun& run, Now now, Outbox& out) {
  for (const TaskRuling& ruling : decision.tasks) {
    if (ruling.ruling != Ruling::move) continue;
    const RobotRecord* robot = situation_.fleet().find(ruling.robot);
    if (alert.verdict == Verdict::accept && (robot == nullptr || !is_fit(*robot))) {
      alerts_.reopen(alert, ruling.robot + " cannot take over any more", out);
      return false;
    }
    const bool listed = std::ranges::find(decision.members, ruling.robot, &Member::id) != decision.members.end();
    if (listed || run.is_member(ruling.robot)) continue;
    const SignedRecord* certificate = situation_.certificate_of(ruling.robot);
    if (certificate == nullptr) {
      alert.waits_for = "the certificate of " + ruling.robot;
      situation_.routes().want(now, RouteRequests::kAtOnce);
      return false;
    }
    decision.members.push_back({ruling.robot, *certificate});
  }
  return true;
}

void Decisions::sign(Alert& alert, const WatchedRun& run, std::vector<TaskRuling> rulings, Now now, Outbox& out) {
  alert.waits_for = "the router's signature";
  Decision decision = decision_of(alert, run, situation_.node(), now);
  if (alerts_.has_decision(decision.run, decision.epoch)) {
    return alerts_.reopen(alert,
                          "epoch " + std::to_string(decision.epoch) +
                              " of its run was decided before, and the own scheduler knows it no more (was its journal "
                              "lost?): end the run with --abort and begin it anew",
                          out, true);
  }
  decision.tasks = std::move(rulings);
  if (!add_members(decision, alert, run, now, out)) return;
  Signing& signing = alerts_.work(alert.id).signing;
  const auto asked = decode<Decision>(signing.payload());
  if (asked && !signing.payload().empty()) decision.time = asked->time;
  signing.prepare(encode(decision), decision.epoch);
  if (!signing.try_sign(now)) return;
  out.request(situation_.node(), SignRequest{std::string(kSignedDecision), {signing.payload()}});
}

void Decisions::receive(const SignedRecord& record, Outbox& out) {
  for (Alert* alert : alerts_.open()) {
    if (alerts_.find_work(alert->id) == nullptr) continue;
    Signing& signing = alerts_.work(alert->id).signing;
    if (!signing.on_signed(record)) continue;
    situation_.note_change();
    if (record.kind != kSignedDecision) return;
    alert->epoch = signing.epoch();
    if (const auto decision = decode<Decision>(record.payload.bytes)) alerts_.keep(*decision, record, out);
    out.record(*alert);
    return;
  }
  out.count("late.signed_record");
}

void Decisions::hand_on(Alert& alert, const WatchedRun& run, Now now, Outbox& out) {
  const Signing& signing = alerts_.work(alert.id).signing;
  alert.waits_for = "the own scheduler to take the decision";
  for (const DecisionView& one : run.view->decisions) {
    if (one.epoch != signing.epoch()) continue;
    if (one.alert == alert.id) return alerts_.finish(alert, out);
    return alerts_.reopen(alert, "epoch " + std::to_string(one.epoch) + " of its run is another decision", out);
  }
  if (run.view->epoch >= signing.epoch()) return alerts_.reopen(alert, "its run has come to another epoch", out);
  if (!signing.refusal().empty()) return alerts_.reopen(alert, "its decision was refused: " + signing.refusal(), out);
  if (take_turn(alert.id, now)) out.command(situation_.node(), RunDecision{*signing.record()}, 0);
}

/// True if this alert may send its record now. One at a time: an answer names no run.
bool Decisions::take_turn(const std::string& alert, Now now) {
  const AlertWork* other = alerts_.find_work(handed_);
  const bool busy = handed_ != alert && other != nullptr && other->signing.awaits_answer(now);
  if (busy || !alerts_.work(alert).signing.try_hand(now)) return false;
  handed_ = alert;
  return true;
}

void Decisions::on_accepted() {
  if (const Alert* alert = alerts_.book().find(handed_)) situation_.runs().refresh(alert->run);
}

void Decisions::on_refused(const Nack& nack, Outbox& out) {
  out.count("nacked." + nack.subtype);
  out.log(LogLevel::warning, "decision_refused", nack.code + ": " + nack.what);
  Alert* alert = alerts_.book().find(handed_);
  if (alert == nullptr || !is_open(*alert)) return;  // too late
  // A record that was only not delivered is sent again.
  constexpr Errc kNotDelivered[] = {Errc::no_service, Errc::queue_full, Errc::expired, Errc::timeout};
  const auto code = errc_of(nack.code);
  if (!code || std::ranges::find(kNotDelivered, *code) == std::end(kNotDelivered)) {
    alerts_.work(alert->id).signing.on_refused(nack.what);
  }
  situation_.runs().refresh(alert->run);
}

}  // namespace trb::resilience
