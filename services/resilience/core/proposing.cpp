// ResilienceCore: an open alert's proposals, and the policy.
#include <algorithm>
#include <cmath>

#include "common/ranking/pairwise.hpp"
#include "proto/value.hpp"
#include "services/resilience/core/plan.hpp"
#include "services/resilience/core/resilience_core.hpp"
#include "services/resilience/core/robot_state.hpp"
#include "services/resilience/core/run_end.hpp"

namespace trb::resilience {
namespace {

constexpr Duration kRankAgain = std::chrono::seconds(5);
/// What is older is asked for. An answer changes the proposals so long after that: later, somebody has read them.
constexpr Duration kFresh = std::chrono::seconds(10);
constexpr Duration kAnswers = std::chrono::seconds(5);

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
  if (!alert.capability.empty() && worst_fault(*robot, "") != nullptr) {
    return close(alert, "the whole robot is broken", out);
  }
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
  // After a start what counts may be another: everybody is asked and proposed anew.
  const bool unasked = !work.asked_at;
  if (unasked || (again && (alert.proposals.empty() || is_stale(alert)))) {
    const Alert before = alert;
    propose(alert, *run, now);
    ask_values(alert, now, out);
    if (!(alert.proposals == before.proposals && alert.unfit == before.unfit)) out.record(alert);
  }
  if (work.heard_at && now.mono - *work.heard_at >= kCrowd) follow_answers(alert, now, out);
  if (alert.state == AlertState::open && alert.expires <= now.utc.ns) {
    alert.state = AlertState::expired;
    out.record(alert);
    out.log(LogLevel::warning, "alert_expired", alert.id + ": nobody has decided; its run stays paused");
  }
  alert.waits_for = open_text(alert);
  if (alert.state == AlertState::open) try_policy(alert, now, out);
}

/// What counts of whoever is proposed, or would be but for a bound, if it is not known or old.
void ResilienceCore::ask_values(const Alert& alert, Now now, Outbox& out) {
  Work& work = works_[alert.id];
  if (work.asked_at && now.mono - *work.asked_at < kRankAgain) return;
  work.asked_at = now.mono;
  work.awaited.clear();
  if (wants_robot(alert)) {  // nobody tells that a robot was stopped: the table does
    ask_routes(now, Duration{0});
    work.awaited.emplace(settings_.node, RouteListRequest::kSubtype);
  }
  std::set<std::string> robots(work.bounded.begin(), work.bounded.end());
  for (const Proposal& proposal : alert.proposals) {
    for (const TaskForRobot& one : proposal.tasks) robots.insert(one.robot);
  }
  // A task is often due because somebody has just arrived: what was told on the way is wrong already.
  const Duration fresh = wants_robot(alert) ? Duration{0} : kFresh;
  for (const std::string& id : robots) {
    const RobotRecord* robot = fleet_.find(id);
    if (robot == nullptr) continue;
    for (const Question& one : questions(settings_.resilience.criteria, *robot, now.utc, fresh)) {
      one.sensor.empty() ? out.request(id, Opaque{one.subtype, ""}) : out.request(id, SensorRead{one.sensor, "", 0});
      work.awaited.emplace(id, one.value);
    }
  }
}

void ResilienceCore::answered(const std::string& robot, const std::string& value) {
  for (auto& [alert, work] : works_) {
    if (work.awaited.erase({robot, value}) != 0 && work.awaited.empty()) stirred_ = true;
  }
}

/// A Nack names no sensor: whoever refuses one is not waited for.
void ResilienceCore::refused_reading(const std::string& robot) {
  for (const ReplacementCriterion& one : settings_.resilience.criteria) {
    if (one.from == CriterionSource::sensor) answered(robot, sensor_value(one.value));
  }
}

/// An answer to what was asked.
void ResilienceCore::hear(const Opaque& value, const std::string& robot, Now now, Outbox& out) {
  answered(robot, value.subtype);
  const auto& criteria = settings_.resilience.criteria;
  const bool asked = value.subtype == kPositionRequest ||
                     std::ranges::find(kChargeRequests, value.subtype) != std::end(kChargeRequests) ||
                     std::ranges::any_of(criteria, [&](const ReplacementCriterion& one) {
                       return one.from == CriterionSource::robot && one.value == value.subtype;
                     });
  if (!asked || !fleet_.on_value(robot, value.subtype, value.data, now.utc)) return out.count("dropped.value");
  note_answer(now, out);
}

void ResilienceCore::hear(const SensorReading& reading, const std::string& robot, Now now, Outbox& out) {
  const RobotRecord* record = fleet_.find(robot);
  bool taken = false;
  for (const ReplacementCriterion& one : settings_.resilience.criteria) {
    if (record == nullptr || reading.is_text || !std::isfinite(reading.number) ||
        !is_sensor_of(one, *record, reading.sensor))
      continue;
    const std::string name = sensor_value(one.value);
    answered(robot, name);
    taken = fleet_.on_value(robot, name, dump_json(Value{reading.number}), now.utc) || taken;
  }
  if (!taken) return out.count("dropped.value");
  note_answer(now, out);
}

/// Nobody has seen the proposals for long: they follow what is heard. Answers come in a crowd, one a robot and value:
/// they are followed when the last has come, or at the latest after kCrowd.
void ResilienceCore::note_answer(Now now, Outbox& out) {
  for (Alert* alert : book_.open()) {
    Work& work = works_[alert->id];
    const bool waits = work.asked_at && now.mono - *work.asked_at <= kAnswers;
    if (!waits || alert->verdict != Verdict::none) continue;
    if (!work.heard_at) work.heard_at = now.mono;
    if (work.awaited.empty()) follow_answers(*alert, now, out);
  }
}

void ResilienceCore::follow_answers(Alert& alert, Now now, Outbox& out) {
  works_[alert.id].heard_at.reset();
  const WatchedRun* run = watcher_.find(alert.run);
  if (run == nullptr || !run->is_known()) return;
  const std::vector<Proposal> before = alert.proposals;
  propose(alert, *run, now);
  if (alert.proposals != before) out.record(alert);
}

bool ResilienceCore::is_out_of_bounds(const WatchedRun& run, std::size_t task, const RobotRecord& robot) const {
  const auto& criteria = settings_.resilience.criteria;
  if (!has_bounds(criteria)) return false;
  const auto needs = needs_of(run, {task}, "");
  return needs && !why_out(criteria, needs->tasks, robot, place_of(robot, needs->tasks, settings_.places)).empty();
}

/// Somebody who was proposed cannot do it any more.
bool ResilienceCore::is_stale(const Alert& alert) const {
  const WatchedRun* run = watcher_.find(alert.run);
  const auto is_able_to = [&](const TaskForRobot& one) {
    const RobotRecord* robot = fleet_.find(one.robot);
    if (robot == nullptr || !is_fit(*robot)) return false;
    const auto index = run == nullptr ? std::nullopt : run->find_task(one.task);
    if (index && std::ranges::count(run->view->tasks[*index].failed_by, one.robot) != 0) return false;
    if (index && is_out_of_bounds(*run, *index, *robot)) return false;
    const SkillInfo* skill = index ? find_skill(*robot, run->view->tasks[*index].skill) : nullptr;
    return skill == nullptr || skill->capability.empty() || is_able(*robot, skill->capability);
  };
  return std::ranges::any_of(
      alert.proposals, [&](const Proposal& proposal) { return !std::ranges::all_of(proposal.tasks, is_able_to); });
}

void ResilienceCore::propose(Alert& alert, const WatchedRun& run, Now now) {
  works_[alert.id].ranked_at = now.mono;
  works_[alert.id].heard_at.reset();
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
  Ways ways = find_ways(fleet_, *needs, settings_.places, settings_.resilience.criteria, now.utc);
  works_[alert.id].bounded = std::move(ways.bounded);
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

}  // namespace trb::resilience
