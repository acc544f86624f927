#include "services/resilience/core/policy.hpp"

#include "common/ranking/pairwise.hpp"
#include "proto/value.hpp"
#include "services/resilience/core/run_problems.hpp"

namespace trb::resilience {
namespace {

/// Failures of one cause come within seconds: the policy waits for them, people take longer anyway.
constexpr Duration kGather = std::chrono::seconds(2);
constexpr const char* kGathers = "other tasks may fail of the same cause";
constexpr Duration kPatience = std::chrono::seconds(2);  ///< how long a task that names no robot waits for answers

/// A robot whose answer is missing, if it was asked less than `patience` ago; empty: none.
std::string awaits(const AlertWork& work, Duration patience, Now now) {
  const std::string robot = work.inquiry.awaited_robot(patience, now);
  return robot.empty() ? robot : "what " + robot + " answers";
}

}  // namespace

/// A task that is moved again and again fails everywhere.
std::string Policy::why_moved_enough(const Alert& alert) const {
  const WatchedRun* run = situation_.runs().find(alert.run);
  const std::uint32_t most = situation_.settings().resilience.policy.max_moves;
  for (const std::string& id : alert.tasks) {
    const auto index = run == nullptr ? std::nullopt : run->find_task(id);
    if (!index || is_pinned(alert, *run, id) || run->policy_moves(*index) < most) continue;
    return "it has moved task '" + id + "' " + std::to_string(run->policy_moves(*index)) + " times: a person decides";
  }
  return {};
}

/// Why the policy leaves the decision to people; empty: it decides.
std::string Policy::why_ask(const Alert& alert, const AlertWork& work, Now now) const {
  const ReplacementPolicy& policy = situation_.settings().resilience.policy;
  if (!work.asks_for.empty()) return work.asks_for;
  if (alert.cause == kOverdue) return "nothing has failed: a person decides what becomes of what is late";
  if (alert.needs_word) return "only a person can say that " + alert.robot + " stands";
  if (alert.proposals.empty()) return "no robot can take over";
  if (std::string enough = why_moved_enough(alert); !enough.empty()) return enough;
  if (alert.severity > policy.max_severity) return "the fault is " + std::string(name_of(alert.severity));
  const double best = alert.proposals[0].score;
  const double lead = best - (alert.proposals.size() > 1 ? alert.proposals[1].score : 0);
  const double merit = alert.proposals[0].merit;
  if (merit < policy.min_score) return "the best has a merit of " + short_number(merit);
  if (lead < policy.min_lead) return "the best leads by " + short_number(lead) + " only";
  if (work.grown_at && now.mono - *work.grown_at < kGather) return kGathers;
  return awaits(work, Inquiry::kAnswers, now);
}

/// Why no robot is chosen yet for a task that names none; empty: the best one is. One task after the other: a robot
/// that gets one is less available for the next.
std::string Policy::why_wait(const Alert& alert, const AlertWork& work, Now now) {
  if (!work.asks_for.empty()) return work.asks_for;
  if (alert.proposals.empty()) return "no robot can do it now";
  if (std::string enough = why_moved_enough(alert); !enough.empty()) return enough;
  for (const Alert* other : alerts_.open()) {
    if (other->state == AlertState::releasing && wants_robot(*other)) return "alert " + other->id + " comes first";
  }
  return awaits(work, kPatience, now);
}

std::string Policy::why_not(const Alert& alert, Now now) {
  const AlertWork& work = alerts_.work(alert.id);
  return wants_robot(alert) ? why_wait(alert, work, now) : why_ask(alert, work, now);
}

void Policy::try_decide(Alert& alert, Now now, Outbox& out) {
  const ReplacementPolicy& policy = situation_.settings().resilience.policy;
  const bool binds = wants_robot(alert);
  const WatchedRun* run = situation_.runs().find(alert.run);
  if (!(binds ? !policy.asks_who_begins : policy.automatic) || !situation_.decides_on(run)) return;
  std::string why = why_not(alert, now);
  if (why.empty() && alerts_.work(alert.id).inquiry.has_new_values()) {
    proposer_.follow_answers(alert, now, out);
    why = why_not(alert, now);
  }
  const bool passes = binds || why == kGathers || why == awaits(alerts_.work(alert.id), Inquiry::kAnswers, now);
  const std::string asks = passes ? "automatic, waits: " : "automatic, but asks: ";
  alert.policy = why.empty() ? "automatic" : cut_utf8(asks + why, 255);
  if (!why.empty()) return;
  if (binds) proposer_.propose(alert, *run, now);  // a robot may have got a task meanwhile
  if (alert.proposals.empty()) return;
  AlertDecide verdict;
  verdict.verdict = Verdict::accept;
  verdict.reason =
      (binds ? "it names no robot: the best of " : "policy: the best of ") + std::to_string(alert.proposals.size());
  const auto decided = verdicts_.decide(alert, verdict, now, out);
  if (!decided) alerts_.work(alert.id).asks_for = decided.error().what;
}

}  // namespace trb::resilience
