#include "services/resilience/core/proposer.hpp"

#include <algorithm>
#include <cmath>
#include <set>

#include "common/scenario/condition.hpp"
#include "proto/body.hpp"
#include "proto/message.hpp"
#include "proto/value.hpp"
#include "services/resilience/core/ranker.hpp"
#include "services/resilience/core/robot_state.hpp"
#include "services/resilience/core/run_problems.hpp"

namespace trb::resilience {
namespace {

/// Older values are requested again. Answers change the proposals only within kAnswers: later, people may have read
/// them.
constexpr Duration kFresh = std::chrono::seconds(10);

void add_unfit(Alert& alert, Unfit one) {
  if (alert.unfit.size() < kMaxUnfit) alert.unfit.push_back(std::move(one));
}

/// The alert's tasks that may move; for the others it notes why they may not.
std::vector<std::size_t> movable(Alert& alert, const WatchedRun& run) {
  std::vector<std::size_t> out;
  for (const std::string& id : alert.tasks) {
    const auto index = run.find_task(id);
    if (!index) continue;
    if (!is_pinned(alert, run, id)) {
      out.push_back(*index);
    } else {
      add_unfit(alert, {alert.robot, "task '" + id + "' is pinned to it: it stays, for --retry or --skip"});
    }
  }
  return out;
}

/// A message takes kMaxRankedCriteria, and resilience.json may list as many besides the paper's three. What is left out
/// then counts nothing, the paper's first.
std::vector<WeighedCriterion> shown_weights(const Criteria& by) {
  static_assert(kMaxCriteria == kMaxRankedCriteria, "else too many may count");
  std::size_t over = by.size() - std::min<std::size_t>(by.size(), kMaxRankedCriteria);
  std::vector<WeighedCriterion> out;
  for (const ReplacementCriterion& one : by) {
    if (over > 0 && one.weight == 0) {
      --over;
    } else {
      out.push_back({one.name, one.weight});
    }
  }
  return out;
}

/// As a condition of a task believes it. A criterion's unit is for people: it is not compared.
bool is_believed(const SensorReading& reading) {
  Condition number;
  number.unit = reading.unit;
  return believe(number, reading).ok() && std::isfinite(reading.number);
}

}  // namespace

void Proposer::propose(Alert& alert, const WatchedRun& run, Now now) {
  Inquiry& inquiry = alerts_.work(alert.id).inquiry;
  inquiry.on_ranked(now);
  alert.expires = (now.utc + situation_.settings().resilience.expires).ns;
  inquiry.set_bounded(fill(alert, run, criteria(), now));
}

std::vector<std::string> Proposer::fill(Alert& alert, const WatchedRun& run, const Criteria& by, Now now) const {
  alert.proposals.clear();
  alert.unfit.clear();
  const std::vector<std::size_t> tasks = movable(alert, run);
  if (tasks.empty()) return {};
  auto needs = needs_of(run, tasks, alert.robot);
  if (!needs) {
    add_unfit(alert, {alert.robot, cut_utf8(needs.error().what, 255)});
    return {};
  }
  for (const auto& [id, certificate] : run.certificates) {
    if (id == alert.robot || !has_new_keys(run, id, situation_.fleet())) continue;
    needs->except.push_back(id);
    add_unfit(alert, {id, kNewKeys});
  }
  Ways ways = find_ways(situation_.fleet(), *needs, situation_.settings().places, by, now.utc);
  alert.proposals = std::move(ways.proposals);
  for (Unfit& one : ways.unfit) add_unfit(alert, std::move(one));
  return std::move(ways.bounded);
}

Result<AlertRanking> Proposer::rank_by(const Alert& alert, const std::vector<WeighedCriterion>& weights, Now now,
                                       Outbox& out) {
  const WatchedRun* run = situation_.runs().find(alert.run);
  if (!is_open(alert) || !may_be_ruled(alert) || run == nullptr || !run->is_known()) {
    return fail(Errc::conflict, "there is nothing to rank for alert " + alert.id, "look at the open alerts");
  }
  const auto by = weighed(criteria(), weights);
  if (!by) return by.error();
  request_values(alert, now, out);
  Alert other = alert;
  fill(other, *run, *by, now);
  AlertRanking answer{alert.id, {}, other.proposals, other.unfit, flips_of(std::move(other), *run, *by, now), false};
  answer.weights = shown_weights(*by);
  const Inquiry& inquiry = alerts_.work(alert.id).inquiry;
  // A message bounds them: an alert may have many tasks, and each proposal names them all.
  while (answer.proposals.size() > 1 && encode(answer).size() > kMaxDataSize / 2) {
    answer.proposals.resize(answer.proposals.size() / 2);
  }
  answer.complete = inquiry.is_complete() || !inquiry.takes_answers(now);
  return answer;
}

/// Of robots that take all the tasks over; between several proposals of shared tasks there is no choice.
std::vector<WeightFlip> Proposer::flips_of(Alert alert, const WatchedRun& run, const Criteria& by, Now now) const {
  const auto needs = needs_of(run, movable(alert, run), alert.robot);
  std::vector<std::string> robots;
  for (const Proposal& one : alert.proposals) {
    if (!one.robot.empty()) robots.push_back(one.robot);
  }
  if (!needs || robots.empty()) return {};
  return weight_flips({situation_.fleet(), situation_.settings().places, by, now.utc}, needs->tasks, std::move(robots));
}

void Proposer::refresh(Alert& alert, const WatchedRun& run, Now now, Outbox& out) {
  const Inquiry& inquiry = alerts_.work(alert.id).inquiry;
  // The criteria may have changed since the last start: all robots are requested and proposed anew.
  const bool wanted = !inquiry.has_begun() || (inquiry.may_rank(now) && (alert.proposals.empty() || is_stale(alert)));
  if (wanted) {
    const std::vector<Proposal> proposals = alert.proposals;
    const std::vector<Unfit> unfit = alert.unfit;
    propose(alert, run, now);
    request_values(alert, now, out);
    if (!(alert.proposals == proposals && alert.unfit == unfit)) out.record(alert);
  }
  const auto follow_at = inquiry.follow_at();
  if (follow_at && *follow_at <= now.mono) follow_answers(alert, now, out);
}

void Proposer::request_values(const Alert& alert, Now now, Outbox& out) {
  Inquiry& inquiry = alerts_.work(alert.id).inquiry;
  if (!inquiry.begin(now)) return;
  if (wants_robot(alert)) {  // no message reports that a robot was stopped, only the table
    situation_.routes().want(now, Duration{0});
    inquiry.await(situation_.node(), std::string(RouteListRequest::kSubtype));
  }
  std::set<std::string> robots(inquiry.bounded().begin(), inquiry.bounded().end());
  for (const Proposal& proposal : alert.proposals) {
    for (const TaskForRobot& one : proposal.tasks) robots.insert(one.robot);
  }
  // A task is often due because a robot has just arrived: values that it reported on its way are outdated.
  const Duration fresh = wants_robot(alert) ? Duration{0} : kFresh;
  for (const std::string& id : robots) {
    if (const RobotRecord* robot = situation_.fleet().find(id)) request_values_of(*robot, fresh, inquiry, now, out);
  }
}

void Proposer::request_values_of(const RobotRecord& robot, Duration fresh, Inquiry& inquiry, Now now,
                                 Outbox& out) const {
  for (const Question& one : questions(criteria(), robot, now.utc, fresh)) {
    one.sensor.empty() ? out.request(robot.id, Opaque{one.subtype, ""})
                       : out.request(robot.id, SensorRead{one.sensor, "", 0});
    inquiry.await(robot.id, one.value);
  }
}

void Proposer::on_reading_refused(const std::string& robot, const std::string& sensor) {
  for (const ReplacementCriterion& one : criteria()) {
    const bool is_meant = sensor.empty() || sensor == one.value;
    if (one.from == CriterionSource::sensor && is_meant) alerts_.on_answer(robot, sensor_value(one.value));
  }
}

/// Does the subtype name a value that may have been requested?
bool Proposer::is_asked_for(const std::string& subtype) const {
  const auto is_criterion = [&](const ReplacementCriterion& one) {
    return one.from == CriterionSource::robot && one.value == subtype;
  };
  return subtype == kPositionRequest || std::ranges::find(kChargeRequests, subtype) != std::end(kChargeRequests) ||
         std::ranges::any_of(criteria(), is_criterion);
}

void Proposer::receive(const Opaque& value, const std::string& robot, Now now, Outbox& out) {
  alerts_.on_answer(robot, value.subtype);
  const bool taken =
      is_asked_for(value.subtype) && situation_.fleet().on_value(robot, value.subtype, value.data, now.utc);
  taken ? on_value(now, out) : out.count("dropped.value");
}

void Proposer::receive(const SensorReading& reading, const std::string& robot, Now now, Outbox& out) {
  const RobotRecord* record = situation_.fleet().find(robot);
  bool taken = false;
  for (const ReplacementCriterion& one : criteria()) {
    if (record == nullptr || !is_sensor_of(one, *record, reading.sensor)) continue;
    const std::string name = sensor_value(one.value);
    alerts_.on_answer(robot, name);
    if (!is_believed(reading)) continue;
    taken = situation_.fleet().on_value(robot, name, dump_json(Value{reading.number}), now.utc) || taken;
  }
  taken ? on_value(now, out) : out.count("dropped.value");
}

/// No person has read the proposals for long: they follow the new values. Answers come almost together, one per robot
/// and value: they are applied when the last has come, or after Inquiry::kCrowd at the latest.
void Proposer::on_value(Now now, Outbox& out) {
  for (Alert* alert : alerts_.open()) {
    Inquiry& inquiry = alerts_.work(alert->id).inquiry;
    if (!inquiry.takes_answers(now) || alert->verdict != Verdict::none) continue;
    inquiry.on_value(now);
    if (inquiry.is_complete()) follow_answers(*alert, now, out);
  }
}

void Proposer::follow_answers(Alert& alert, Now now, Outbox& out) {
  alerts_.work(alert.id).inquiry.on_followed();
  const WatchedRun* run = situation_.runs().find(alert.run);
  if (run == nullptr || !run->is_known()) return;
  const std::vector<Proposal> before = alert.proposals;
  propose(alert, *run, now);
  if (alert.proposals != before) out.record(alert);
}

bool Proposer::is_out_of_bounds(const WatchedRun& run, std::size_t task, const RobotRecord& robot) const {
  if (!has_bounds(criteria())) return false;
  const auto needs = needs_of(run, {task}, "");
  if (!needs) return false;
  return !why_out(criteria(), needs->tasks, robot, place_of(robot, needs->tasks, situation_.settings().places)).empty();
}

bool Proposer::is_able_to(const TaskForRobot& one, const WatchedRun* run) const {
  const RobotRecord* robot = situation_.fleet().find(one.robot);
  if (robot == nullptr || !is_fit(*robot)) return false;
  const auto index = run == nullptr ? std::nullopt : run->find_task(one.task);
  if (!index) return true;
  if (has_new_keys(*run, one.robot, situation_.fleet())) return false;
  if (std::ranges::count(run->view->tasks[*index].failed_by, one.robot) != 0) return false;
  if (is_out_of_bounds(*run, *index, *robot)) return false;
  const SkillInfo* skill = find_skill(*robot, run->view->tasks[*index].skill);
  return skill == nullptr || skill->capability.empty() || is_able(*robot, skill->capability);
}

bool Proposer::is_stale(const Alert& alert) const {
  const WatchedRun* run = situation_.runs().find(alert.run);
  const auto holds = [&](const Proposal& proposal) {
    return std::ranges::all_of(proposal.tasks, [&](const TaskForRobot& one) { return is_able_to(one, run); });
  };
  return !std::ranges::all_of(alert.proposals, holds);
}

}  // namespace trb::resilience
