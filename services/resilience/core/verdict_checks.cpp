#include "services/resilience/core/verdict_checks.hpp"

#include <algorithm>

#include "proto/value.hpp"
#include "services/resilience/core/plan.hpp"
#include "services/resilience/core/run_problems.hpp"

namespace trb::resilience {
namespace {

constexpr const char* kStands = "say --stands if you have seen that it stands";

/// The chosen proposal: of one robot, or of several; the best if none is named.
std::vector<Proposal>::iterator find_proposal(Alert& alert, const AlertDecide& body) {
  return std::ranges::find_if(alert.proposals, [&](const Proposal& one) {
    return (body.robot.empty() || one.robot == body.robot) && is_as_shown(one, body.shown);
  });
}

std::string tasks_of(const Proposal& proposal) {
  std::string out;
  for (const TaskForRobot& one : proposal.tasks) out += (out.empty() ? "" : ", ") + one.task + " to " + one.robot;
  return cut_utf8(out, 512);
}

std::string robots_of(const std::vector<Proposal>& proposals) {
  std::string out;
  for (const Proposal& one : proposals) out += (out.empty() ? "" : ", ") + one.robot;
  return out;
}

bool moves(Verdict verdict) {
  return verdict == Verdict::accept || verdict == Verdict::override_;
}

}  // namespace

bool is_as_shown(const Proposal& proposal, const std::vector<TaskForRobot>& shown) {
  if (shown.empty()) return true;
  return std::ranges::all_of(proposal.tasks,
                             [&](const TaskForRobot& one) { return std::ranges::find(shown, one) != shown.end(); });
}

Status VerdictChecks::check_decider(const Alert& alert, const WatchedRun* run, const AlertDecide& body) const {
  if (run == nullptr || !run->is_known() || !situation_.is_judged()) {
    return fail(Errc::unknown_run, "run " + alert.run + " is not known by this node's scheduler now", "try again");
  }
  if (!situation_.decides_on(run)) {
    const std::string who = run->decider();
    return fail(Errc::not_permitted, "this node does not decide on run " + alert.run,
                who.empty() ? "the run has no cloud node: abort it" : "say it on node '" + who + "'");
  }
  if (body.verdict == Verdict::none) {
    return fail(Errc::missing, "no verdict", "--robot, --override, --retry, --skip or --abort");
  }
  if (run->recovers() && body.verdict != Verdict::abort) {
    return fail(Errc::timeout, "what was decided on the run before is not known on this node yet",
                "it waits for " + run->summary.waits_for);
  }
  if (may_be_ruled(alert) || body.verdict == Verdict::abort) return Done{};
  const std::string short_id = alert.run.substr(0, 8);
  if (alert.cause == kTwice) {
    return fail(Errc::conflict, "it was done twice: there is nothing to move, to try again or to skip",
                "look at what was done, then trb scenario resume " + short_id + ", or --abort");
  }
  return fail(Errc::conflict, "the run's time is over soon: no verdict moves its end", "let it end, or --abort");
}

/// A task that has not failed cannot be tried again.
Status VerdictChecks::check_retry_of(const Alert& alert, const WatchedRun& run) {
  if (alert.cause != kOverdue && alert.cause != kAsked) return Done{};
  for (const std::string& id : alert.tasks) {
    const auto index = run.find_task(id);
    if (index && run.has_stopped(*index)) return Done{};
  }
  return fail(Errc::conflict, "its tasks have not failed: there is nothing to try again",
              "--robot, --override or --skip");
}

/// The chosen robot is known, reached, and may be given the tasks.
Status VerdictChecks::check_override(const Alert& alert, const AlertDecide& body, const WatchedRun& run) const {
  if (body.robot.empty() || body.reason.empty()) {
    return fail(Errc::missing, "an override needs a robot and a reason", "--override ROBOT --reason TEXT");
  }
  const RobotRecord* robot = situation_.fleet().find(body.robot);
  if (robot == nullptr) return fail(Errc::unknown_target, "'" + body.robot + "' is not known", "trb robot list");
  if (body.robot == alert.robot) return fail(Errc::bad_value, "it is the robot that failed", "use --retry");
  if (!robot->reached || robot->profile.is.robot != "ONLINE" || retirement_of(*robot) != nullptr) {
    return fail(Errc::conflict, "'" + body.robot + "' is not there: " + why_unfit(*robot),
                "bring it back, or name another one");
  }
  if (has_new_keys(run, body.robot, situation_.fleet())) {
    return fail(Errc::conflict, "'" + body.robot + "' cannot take over: " + kNewKeys, "name another one");
  }
  return check_able(*robot, alert, run);
}

Status VerdictChecks::check_able(const RobotRecord& robot, const Alert& alert, const WatchedRun& run) {
  std::vector<std::size_t> tasks;
  for (const std::string& id : alert.tasks) {
    if (const auto index = run.find_task(id)) tasks.push_back(*index);
  }
  const auto needs = needs_of(run, tasks, alert.robot);
  if (!needs) return needs.error();
  for (const TaskNeed& need : needs->tasks) {
    const std::string why = why_unable(robot, need);
    if (!why.empty())
      return fail(Errc::bad_value, "'" + robot.id + "' cannot do task '" + need.task + "': " + why,
                  "trb alert list says who can");
  }
  return Done{};
}

Status VerdictChecks::take_proposal(Alert& alert, const AlertDecide& body, const WatchedRun& run, Now now) {
  if (alert.proposals.empty() || alert.state == AlertState::expired || proposer_.is_stale(alert)) {
    proposer_.propose(alert, run, now);
  }
  if (alert.proposals.empty()) {
    return fail(Errc::conflict, "no robot can take over", "trb alert list says why; --retry, --skip or --abort");
  }
  const auto chosen = find_proposal(alert, body);
  if (chosen == alert.proposals.end() && !body.shown.empty()) {
    return fail(Errc::conflict, "what you were shown is not proposed any more",
                "look at it again; the best is now: " + tasks_of(alert.proposals.front()));
  }
  if (chosen == alert.proposals.end()) {
    return fail(Errc::bad_value, "'" + body.robot + "' is not proposed",
                "use one of " + robots_of(alert.proposals) + ", or --override with a reason");
  }
  std::rotate(alert.proposals.begin(), chosen, chosen + 1);
  return Done{};
}

Status VerdictChecks::take_override(Alert& alert, const AlertDecide& body, const WatchedRun& run) const {
  if (Status good = check_override(alert, body, run); !good) return good;
  Proposal own{body.robot, {}, 0, {}, cut_utf8("override: " + body.reason, 512)};
  for (const std::string& task : alert.tasks) own.tasks.push_back({task, body.robot});
  alert.proposals.insert(alert.proposals.begin(), std::move(own));
  if (alert.proposals.size() > kMaxProposals) alert.proposals.resize(kMaxProposals);
  return Done{};
}

Status VerdictChecks::check_confirmation(const Alert& alert, const AlertDecide& body, const WatchedRun& run) const {
  if (body.stands || body.verdict == Verdict::abort) return Done{};
  for (const std::string& id : alert.tasks) {
    const auto index = run.find_task(id);
    if (!index) continue;
    const std::string why = why_confirmation(run, *index, situation_.fleet(), body.verdict == Verdict::retry);
    if (!why.empty()) return fail(Errc::bad_value, why, kStands);
  }
  return Done{};
}

Status VerdictChecks::check_retry(const Alert& alert, const WatchedRun& run, Now now) const {
  if (wants_robot(alert)) return fail(Errc::bad_value, "nothing has failed: there is nothing to try again");
  const Liveness::Gone* gone = situation_.liveness().find(alert.robot, now);
  const RobotRecord* robot = situation_.fleet().find(alert.robot);
  if (const OutOfUse* retired = robot == nullptr ? nullptr : retirement_of(*robot)) {
    return fail(Errc::conflict, alert.robot + " cannot try again: it " + retired_text(*retired),
                "trb robot return " + alert.robot + ", or let another one");
  }
  if (has_new_keys(run, alert.robot, situation_.fleet())) {
    return fail(Errc::conflict, alert.robot + " cannot try again: " + kNewKeys,
                "let another one: --robot, --override, or --skip or --abort");
  }
  if (gone == nullptr) return Done{};
  return fail(Errc::conflict, alert.robot + " cannot try again: " + gone->text, "bring it back, or let another one");
}

/// Can the run take another decision?
Status VerdictChecks::check_decisions(const Alert& alert, const WatchedRun& run) {
  std::uint32_t decided = run.view->epoch - 1;
  for (const Alert* other : alerts_.open()) {
    const bool comes = other->run == alert.run && other->id != alert.id && other->state == AlertState::releasing &&
                       other->verdict != Verdict::abort;
    decided += comes ? 1 : 0;
  }
  if (decided < kMaxDecisions) return Done{};
  return fail(Errc::conflict,
              "run " + alert.run + " has its " + std::to_string(kMaxDecisions) + " decisions: it takes no more",
              "--abort, or let it end");
}

/// Refuses what the scheduler would refuse for good.
Status VerdictChecks::check_bounds(const Alert& alert, const WatchedRun& run) {
  if (alert.verdict == Verdict::abort) return Done{};
  if (Status good = check_decisions(alert, run); !good) return good;
  const bool skips = alert.verdict == Verdict::skip;
  for (const TaskRuling& ruling : plan_of(alert, run, situation_.fleet(), situation_.node(), true).rulings) {
    if (ruling.attempt <= kMaxAttempts + (skips ? 1 : 0)) continue;
    return fail(Errc::conflict,
                "task '" + ruling.task + "' would come to attempt " + std::to_string(ruling.attempt) + ", " +
                    std::to_string(kMaxAttempts) + " are the most",
                skips ? "--abort" : "--skip or --abort");
  }
  return Done{};
}

/// Applies the verdict to the alert.
Status VerdictChecks::shape(Alert& alert, const AlertDecide& body, const WatchedRun& run, Now now) {
  Status good = narrow(alert, body, run);
  if (good && body.verdict == Verdict::accept) good = take_proposal(alert, body, run, now);
  if (good && body.verdict == Verdict::override_) good = take_override(alert, body, run);
  if (good && body.verdict == Verdict::retry) good = check_retry(alert, run, now);
  if (good && body.verdict == Verdict::retry) good = check_retry_of(alert, run);
  if (good) good = check_confirmation(alert, body, run);
  if (!good) return good;
  alert.verdict = body.verdict;
  alert.person = body.person;
  alert.reason = body.reason;
  // From here on needs_word records that a person has stated that the robot stands.
  alert.needs_word = body.stands;
  alert.state = AlertState::releasing;
  return check_bounds(alert, run);
}

/// Narrows the alert to the named tasks; a move without names means those that may move.
Status VerdictChecks::narrow(Alert& alert, const AlertDecide& body, const WatchedRun& run) {
  const bool named = !body.tasks.empty();
  if (named && body.verdict == Verdict::abort) {
    return fail(Errc::bad_value, "tasks: a run is aborted as a whole", "leave --task out");
  }
  for (const std::string& id : body.tasks) {
    if (std::ranges::find(alert.tasks, id) == alert.tasks.end()) {
      return fail(Errc::bad_value, "tasks: '" + cut_utf8(id, 64) + "' is none of alert " + alert.id,
                  "trb alert list tells its tasks");
    }
  }
  std::vector<std::string> kept;
  for (const std::string& id : alert.tasks) {
    if (named && std::ranges::find(body.tasks, id) == body.tasks.end()) continue;
    const bool stays = moves(body.verdict) && is_pinned(alert, run, id);
    if (!stays) kept.push_back(id);
    if (stays && (named || alert.tasks.size() == 1)) {
      return fail(Errc::conflict, "task '" + id + "' is pinned to " + alert.robot, "use --retry, --skip or --abort");
    }
  }
  if (kept.empty()) {
    return fail(Errc::conflict, "its tasks are pinned to " + alert.robot, "use --retry, --skip or --abort");
  }
  if (named && kept != alert.tasks) alert.proposals.clear();  // they were made for all of them
  alert.tasks = std::move(kept);
  return Done{};
}

}  // namespace trb::resilience
