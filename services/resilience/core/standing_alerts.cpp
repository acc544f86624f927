#include "services/resilience/core/standing_alerts.hpp"

#include "proto/value.hpp"
#include "services/resilience/core/alert_text.hpp"
#include "services/resilience/core/run_problems.hpp"

namespace trb::resilience {

void StandingAlerts::raise_due(Now now, Outbox& out) {
  uncovered_.follow(situation_.fleet(), now);
  for (const Alert* alert : alerts_.open()) {
    if (alert->cause != kRobotFault) continue;
    const RobotRecord* robot = situation_.fleet().find(alert->robot);
    if (robot == nullptr) continue;
    for (const Fault& fault : robot->faults) {
      if (covers(*alert, fault.capability)) uncovered_.cover({alert->robot, fault.capability}, now);
    }
  }
  for (const UncoveredFaults::Key& key : uncovered_.uncovered(now)) {
    if (!alerts_.book().has_room_for_lone(key.robot)) {
      out.count("dropped.alerts");
      continue;
    }
    const RobotRecord& robot = *situation_.fleet().find(key.robot);
    if (!key.capability.empty() && worst_fault(robot, "") != nullptr) continue;  // the whole robot's alert covers it
    if (raise(key, now, out) == nullptr) return;
  }
}

Alert* StandingAlerts::raise(const UncoveredFaults::Key& key, Now now, Outbox& out) {
  const Fault& fault = *worst_fault(*situation_.fleet().find(key.robot), key.capability);
  Alert fresh;
  fresh.robot = key.robot;
  fresh.capability = key.capability;
  fresh.severity = fault.severity;
  fresh.cause = kRobotFault;
  fresh.text = cut_utf8(fault.text, kMaxAlertText);
  fresh.time = now.utc.ns;
  Alert* alert = alerts_.raise(std::move(fresh), now, out);
  if (alert == nullptr) return nullptr;
  uncovered_.cover(key, now);
  look(*alert, now, out);
  out.record(*alert);
  out.log(LogLevel::warning, "alert_raised", alert->id + ": " + alert->robot + ": " + alert->text + " (no run)");
  return alert;
}

void StandingAlerts::look(Alert& alert, Now now, Outbox& out) {
  const RobotRecord* robot = situation_.fleet().find(alert.robot);
  const Fault* worst = robot == nullptr ? nullptr : worst_fault(*robot, alert.capability);
  if (worst == nullptr) {
    const bool mended = alert.verdict == Verdict::retry;
    if (robot == nullptr) return alerts_.close(alert, alert.robot + " is known no more", out);
    return alerts_.close(alert, mended ? "taken as mended" : "the fault is over", out);
  }
  if (alert.verdict == Verdict::retry && repairs_.is_awaited(alert, now, out)) return;
  if (!alert.capability.empty() && worst_fault(*robot, "") != nullptr) {
    return alerts_.close(alert, "the whole robot is broken", out);
  }
  for (const Alert* other : alerts_.open()) {
    const bool is_covered = !other->run.empty() && other->robot == alert.robot && covers(*other, alert.capability);
    if (is_covered) return alerts_.close(alert, "run alert " + other->id, out);
  }
  if (worst->severity > alert.severity) {
    alert.severity = worst->severity;
    alert.text = text_reworded(alert.text, worst->text);
    out.record(alert);
  }
  alert.waits_for =
      "somebody to mend " + alert.robot + "; then: trb alert decide " + alert.id.substr(0, 8) + " --retry";
}

std::optional<MonotonicTime> StandingAlerts::next(Now now) {
  uncovered_.follow(situation_.fleet(), now);
  return uncovered_.next(now);
}

}  // namespace trb::resilience
