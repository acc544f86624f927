#include "services/resilience/core/alert_updater.hpp"

#include "services/resilience/core/run_end.hpp"
#include "services/resilience/core/run_over.hpp"
#include "services/resilience/core/run_problems.hpp"

namespace trb::resilience {

void AlertUpdater::look(Alert& alert, Now now, Outbox& out) {
  const RunWatcher& runs = situation_.runs();
  const WatchedRun* run = runs.find(alert.run);
  if (run == nullptr) {
    if (runs.has_table()) alerts_.close(alert, run_over_text(runs, alert.run), out);
    return;
  }
  if (!run->is_known()) return;
  if (run->recovers()) return wait_for_members(alert, *run);
  if (!may_be_ruled(alert)) return look_at_notice(alert, *run, now);
  proposer_.refresh(alert, *run, now, out);
  const bool expired = is_expired(alert, now);
  if (expired) expire(alert, out);
  alert.waits_for = waits_for(alert, *run);
  // The proposals of an alert that had expired may be new: a robot has come, or another one has failed.
  if (!expired) policy_.try_decide(alert, now, out);
}

/// What was proposed rests on what may be old: it is asked and proposed anew afterwards, as if the alert were new.
void AlertUpdater::wait_for_members(Alert& alert, const WatchedRun& run) {
  alert.waits_for = recovery_text(run);
  alerts_.work(alert.id).inquiry = {};
}

/// A notice only informs; there is nothing to propose.
void AlertUpdater::look_at_notice(Alert& alert, const WatchedRun& run, Now now) {
  const std::string id = run.summary.run.substr(0, 8);
  alert.waits_for = alert.cause == kRunEnds
                        ? wait_for_end(run, now)
                        : "trb scenario resume " + id + " once somebody has looked, or trb scenario abort " + id;
}

/// By the monotonic clock, whatever becomes of UTC: Alert::expires is only shown.
bool AlertUpdater::is_expired(const Alert& alert, Now now) const {
  const AlertWork* work = alerts_.find_work(alert.id);
  const auto made_at = work == nullptr ? std::nullopt : work->inquiry.ranked_at();
  return made_at && now.mono - *made_at >= situation_.settings().resilience.expires;
}

void AlertUpdater::expire(Alert& alert, Outbox& out) {
  if (alert.state != AlertState::open) return;
  alert.state = AlertState::expired;
  out.record(alert);
  out.log(LogLevel::warning, "alert_expired", alert.id + ": nobody has decided; its run stays paused");
}

/// A robot may answer, and nobody knows what became of its task nevertheless.
std::string AlertUpdater::why_word(const Alert& alert, const WatchedRun& run) const {
  for (const std::string& id : alert.tasks) {
    const auto task = run.find_task(id);
    std::string why = task ? why_confirmation(run, *task, situation_.fleet(), false) : std::string();
    if (!why.empty()) return why;
  }
  return "its state is not known";
}

std::string AlertUpdater::waits_for(const Alert& alert, const WatchedRun& run) const {
  if (!situation_.decides_on(&run)) {
    const std::string who = run.decider();
    return who.empty() ? "a cloud node: the run has none, so nobody decides; abort it" : "a verdict on node " + who;
  }
  std::string out = "a verdict: trb alert decide " + alert.id.substr(0, 8);
  if (wants_robot(alert)) {
    if (!alert.proposals.empty()) return out;
    return "a robot that can do task '" + alert.tasks.front() + "', or " + out + " --skip or --abort";
  }
  if (alert.proposals.empty()) out += " (no robot can take over: --retry, --skip or --abort)";
  if (alert.needs_word)
    out += "; " + why_word(alert, run) + ": --stands if you have seen that " + alert.robot + " stands";
  return out;
}

}  // namespace trb::resilience
