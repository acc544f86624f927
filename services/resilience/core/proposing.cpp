// ResilienceCore: an open alert's proposals, and the policy.
#include <algorithm>

#include "common/ranking/pairwise.hpp"
#include "proto/value.hpp"
#include "services/resilience/core/plan.hpp"
#include "services/resilience/core/resilience_core.hpp"
#include "services/resilience/core/robot_state.hpp"
#include "services/resilience/core/run_end.hpp"

namespace trb::resilience {
namespace {

constexpr Duration kRankAgain = std::chrono::seconds(5);
/// What fails of one cause comes within seconds: the policy waits for it, people take longer anyway.
constexpr Duration kGather = std::chrono::seconds(2);
constexpr const char* kGathers = "other tasks may fail of the same cause";
/// What is older is asked for. An answer changes the proposals so long after that: later, somebody has read them.
constexpr Duration kFresh = std::chrono::seconds(10);
constexpr Duration kAnswers = std::chrono::seconds(5);
constexpr Duration kPatience = std::chrono::seconds(2);  ///< so long a task that names no robot waits for answers

}  // namespace

void ResilienceCore::look_at_alerts(Now now, Outbox& out) {
  for (Alert* alert : book_.open()) {
    if (alert->run.empty()) {
      look_at_lone(*alert, now, out);
    } else if (alert->state == AlertState::releasing) {
      advance(*alert, now, out);
    } else {
      look_at_open(*alert, now, out);
    }
  }
  book_.prune();
}

/// No run needs the robot. The alert is there as long as the fault is, or until a run's alert tells of it.
void ResilienceCore::look_at_lone(Alert& alert, Now now, Outbox& out) {
  const RobotRecord* robot = fleet_.find(alert.robot);
  if (robot == nullptr || worst_fault(*robot, alert.capability) == nullptr) {
    return close(alert, alert.verdict == Verdict::retry ? "taken as mended" : "the fault is over", out);
  }
  if (alert.verdict == Verdict::retry && waits_for_mending(alert, now, out)) return;
  for (const Alert* other : book_.open()) {
    const bool tells = !other->run.empty() && other->robot == alert.robot && tells_of(*other, alert.capability);
    if (tells) return close(alert, "run alert " + other->id, out);
  }
  alert.waits_for =
      "somebody to mend " + alert.robot + "; then: trb alert decide " + alert.id.substr(0, 8) + " --retry";
}

/// It tells what is; there is nothing to propose.
void ResilienceCore::look_at_notice(Alert& alert, const WatchedRun& run, Now now) {
  const std::string id = run.summary.run.substr(0, 8);
  alert.waits_for = alert.cause == kRunEnds
                        ? wait_for_end(run, now)
                        : "trb scenario resume " + id + " once somebody has looked, or trb scenario abort " + id;
}

/// How its run has ended.
std::string ResilienceCore::run_over_text(const std::string& run) const {
  if (watcher_.ended(run) != RunState::expired) return "its run is over";
  return "its run has EXPIRED: trb run show " + run.substr(0, 8) + " has everything";
}

void ResilienceCore::look_at_open(Alert& alert, Now now, Outbox& out) {
  const WatchedRun* run = watcher_.find(alert.run);
  if (run == nullptr) {
    if (watcher_.has_table()) close(alert, run_over_text(alert.run), out);
    return;
  }
  if (!run->is_known()) return;
  if (!may_be_ruled(alert)) return look_at_notice(alert, *run, now);
  Work& work = works_[alert.id];
  const bool again = !work.ranked_at || now.mono - *work.ranked_at >= kRankAgain;
  const bool unasked = wants_robot(alert) && !work.asked_at;  // nobody may look at it again
  if (unasked || (again && (alert.proposals.empty() || is_stale(alert)))) {
    const Alert before = alert;
    propose(alert, *run, now);
    ask_values(alert, now, out);
    if (!(alert.proposals == before.proposals && alert.unfit == before.unfit)) out.record(alert);
  }
  if (alert.state == AlertState::open && alert.expires <= now.utc.ns) {
    alert.state = AlertState::expired;
    out.record(alert);
    out.log(LogLevel::warning, "alert_expired", alert.id + ": nobody has decided; its run stays paused");
  }
  alert.waits_for = open_text(alert);
  if (alert.state == AlertState::open) try_policy(alert, now, out);
}

/// Charge and position of whoever is proposed, if they are not known or old.
void ResilienceCore::ask_values(const Alert& alert, Now now, Outbox& out) {
  Work& work = works_[alert.id];
  if (work.asked_at && now.mono - *work.asked_at < kRankAgain) return;
  work.asked_at = now.mono;
  work.awaited.clear();
  if (wants_robot(alert)) {  // nobody tells that a robot was stopped: the table does
    ask_routes(now, Duration{0});
    work.awaited.emplace(settings_.node, RouteListRequest::kSubtype);
  }
  std::set<std::string> robots;
  for (const Proposal& proposal : alert.proposals) {
    for (const TaskForRobot& one : proposal.tasks) robots.insert(one.robot);
  }
  // A task is often due because somebody has just arrived: what was told on the way is wrong already.
  const Duration fresh = wants_robot(alert) ? Duration{0} : kFresh;
  const auto is_old = [&](const auto& told) { return !told || told->at + fresh < now.utc; };
  for (const std::string& id : robots) {
    const RobotRecord* robot = fleet_.find(id);
    if (robot == nullptr) continue;
    const auto ask = [&](std::string_view value) {
      out.request(id, Opaque{std::string(value), ""});
      work.awaited.emplace(id, value);
    };
    if (is_old(charge_of(*robot))) ask(charge_request(robot->profile.is));
    if (is_old(position_of(*robot))) ask(kPositionRequest);
  }
}

void ResilienceCore::answered(const std::string& robot, const std::string& value) {
  for (auto& [alert, work] : works_) {
    if (work.awaited.erase({robot, value}) != 0) stirred_ = true;
  }
}

/// An answer: nobody has seen the proposals for long, they follow it.
void ResilienceCore::hear(const Opaque& value, const std::string& robot, Now now, Outbox& out) {
  answered(robot, value.subtype);
  const bool asked = value.subtype == kPositionRequest ||
                     std::ranges::find(kChargeRequests, value.subtype) != std::end(kChargeRequests);
  if (!asked || !fleet_.on_value(robot, value.subtype, value.data, now.utc)) return out.count("dropped.value");
  for (Alert* alert : book_.open()) {
    const WatchedRun* run = watcher_.find(alert->run);
    const Work& work = works_[alert->id];
    const bool waits = work.asked_at && now.mono - *work.asked_at <= kAnswers;
    if (!waits || alert->verdict != Verdict::none || run == nullptr || !run->is_known()) continue;
    const std::vector<Proposal> before = alert->proposals;
    propose(*alert, *run, now);
    if (alert->proposals != before) out.record(*alert);
  }
}

/// Somebody who was proposed cannot do it any more.
bool ResilienceCore::is_stale(const Alert& alert) const {
  const WatchedRun* run = watcher_.find(alert.run);
  const auto is_able_to = [&](const TaskForRobot& one) {
    const RobotRecord* robot = fleet_.find(one.robot);
    if (robot == nullptr || !is_fit(*robot)) return false;
    const auto index = run == nullptr ? std::nullopt : run->find_task(one.task);
    if (index && std::ranges::count(run->view->tasks[*index].failed_by, one.robot) != 0) return false;
    const SkillInfo* skill = index ? find_skill(*robot, run->view->tasks[*index].skill) : nullptr;
    return skill == nullptr || skill->capability.empty() || is_able(*robot, skill->capability);
  };
  return std::ranges::any_of(
      alert.proposals, [&](const Proposal& proposal) { return !std::ranges::all_of(proposal.tasks, is_able_to); });
}

void ResilienceCore::propose(Alert& alert, const WatchedRun& run, Now now) {
  works_[alert.id].ranked_at = now.mono;
  alert.expires = (now.utc + settings_.resilience.expires).ns;
  alert.proposals.clear();
  alert.unfit.clear();
  std::vector<std::size_t> tasks;
  for (const std::string& id : alert.tasks) {
    const auto index = run.find_task(id);
    if (!index) continue;
    if (!is_pinned(alert, run, id)) {
      tasks.push_back(*index);
    } else if (alert.unfit.size() < kMaxUnfit) {
      alert.unfit.push_back({alert.robot, "task '" + id + "' is pinned to it: it stays, for --retry or --skip"});
    }
  }
  if (tasks.empty()) return;
  const auto needs = needs_of(run, tasks, alert.robot);
  if (!needs) {
    if (alert.unfit.size() < kMaxUnfit) alert.unfit.push_back({alert.robot, cut_utf8(needs.error().what, 255)});
    return;
  }
  Ways ways = find_ways(fleet_, *needs, settings_.places, settings_.resilience.weights, now.utc);
  alert.proposals = std::move(ways.proposals);
  for (Unfit& one : ways.unfit) {
    if (alert.unfit.size() < kMaxUnfit) alert.unfit.push_back(std::move(one));
  }
}

bool ResilienceCore::decides(const Alert& alert) const {
  const WatchedRun* run = watcher_.find(alert.run);
  return settings_.role == Role::cloud && run != nullptr && run->decider() == settings_.node;
}

std::string ResilienceCore::open_text(const Alert& alert) const {
  const WatchedRun* run = watcher_.find(alert.run);
  if (!decides(alert)) {
    const std::string who = run == nullptr ? "" : run->decider();
    return who.empty() ? "a cloud node: the run has none, so nobody decides; abort it" : "a verdict on node " + who;
  }
  std::string out = "a verdict: trb alert decide " + alert.id.substr(0, 8);
  if (wants_robot(alert)) {
    if (!alert.proposals.empty()) return out;
    return "a robot that can do task '" + alert.tasks.front() + "', or " + out + " --skip or --abort";
  }
  if (alert.proposals.empty()) out += " (no robot can take over: --retry, --skip or --abort)";
  if (alert.needs_word) out += "; nobody hears what " + alert.robot + " does: --stands if you have seen that it stands";
  return out;
}

/// Who is moved again and again fails everywhere.
std::string ResilienceCore::why_moved_enough(const Alert& alert) const {
  const WatchedRun* run = watcher_.find(alert.run);
  const std::uint32_t most = settings_.resilience.policy.max_moves;
  for (const std::string& id : alert.tasks) {
    const auto index = run == nullptr ? std::nullopt : run->find_task(id);
    if (!index || is_pinned(alert, *run, id) || run->policy_moves(*index) < most) continue;
    return "it has moved task '" + id + "' " + std::to_string(run->policy_moves(*index)) + " times: a person decides";
  }
  return {};
}

/// Why the policy does not decide; empty: it does.
std::string ResilienceCore::why_ask(const Alert& alert, Now now) {
  const ReplacementPolicy& policy = settings_.resilience.policy;
  const Work& work = works_[alert.id];
  if (!work.asks_for.empty()) return work.asks_for;
  if (alert.cause == kOverdue) return "nothing has failed: a person decides what becomes of what is late";
  if (alert.needs_word) return "only a person can say that " + alert.robot + " stands";
  if (alert.proposals.empty()) return "no robot can take over";
  if (std::string enough = why_moved_enough(alert); !enough.empty()) return enough;
  if (alert.severity > policy.max_severity) return "the fault is " + std::string(name_of(alert.severity));
  const double best = alert.proposals[0].score;
  const double lead = best - (alert.proposals.size() > 1 ? alert.proposals[1].score : 0);
  if (best < policy.min_score) return "the best score is " + short_number(best);
  if (lead < policy.min_lead) return "the best leads by " + short_number(lead) + " only";
  if (work.grown_at && now.mono - *work.grown_at < kGather) return kGathers;
  return awaits(work, kAnswers, now);
}

/// Who is to answer yet, if it was asked less than `patience` ago; empty: nobody.
std::string ResilienceCore::awaits(const Work& work, Duration patience, Now now) {
  const bool waits = work.asked_at && now.mono - *work.asked_at < patience && !work.awaited.empty();
  return waits ? "what " + work.awaited.begin()->first + " answers" : "";
}

/// Why nobody is chosen yet for a task that names no robot; empty: the best is. One task after the other: who gets one
/// is less at hand for the next.
std::string ResilienceCore::why_wait(const Alert& alert, Now now) {
  const Work& work = works_[alert.id];
  if (!work.asks_for.empty()) return work.asks_for;
  if (alert.proposals.empty()) return "no robot can do it now";
  if (std::string enough = why_moved_enough(alert); !enough.empty()) return enough;
  for (const Alert* other : book_.open()) {
    if (other->state == AlertState::releasing && wants_robot(*other)) return "alert " + other->id + " comes first";
  }
  return awaits(work, kPatience, now);
}

void ResilienceCore::try_policy(Alert& alert, Now now, Outbox& out) {
  const ReplacementPolicy& policy = settings_.resilience.policy;
  const bool binds = wants_robot(alert);
  if (!(binds ? !policy.asks_who_begins : policy.automatic) || !decides(alert)) return;
  const std::string why = binds ? why_wait(alert, now) : why_ask(alert, now);
  const bool passes = binds || why == kGathers || why == awaits(works_[alert.id], kAnswers, now);
  const std::string asks = passes ? "automatic, waits: " : "automatic, but asks: ";
  alert.policy = why.empty() ? "automatic" : cut_utf8(asks + why, 255);
  if (!why.empty()) return;
  if (binds) propose(alert, *watcher_.find(alert.run), now);  // somebody may have got a task meanwhile
  if (alert.proposals.empty()) return;
  AlertDecide verdict;
  verdict.verdict = Verdict::accept;
  verdict.reason =
      (binds ? "it names no robot: the best of " : "policy: the best of ") + std::to_string(alert.proposals.size());
  if (const auto decided = decide(alert, verdict, now, out); !decided) works_[alert.id].asks_for = decided.error().what;
}

}  // namespace trb::resilience
