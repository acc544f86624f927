#include "services/resilience/core/repairs.hpp"

#include <set>

#include "proto/value.hpp"

namespace trb::resilience {
namespace {

std::string quoted(const std::vector<std::string>& capabilities) {
  std::string out;
  for (const std::string& one : capabilities)
    out += (out.empty() ? "" : ", ") + (one.empty() ? "itself" : "'" + one + "'");
  return out;
}

/// Does a repair of the alert's capability concern that fault?
bool concerns(const Alert& alert, const Fault& fault) {
  return alert.capability.empty() || fault.capability.empty() || fault.capability == alert.capability;
}

}  // namespace

void Repairs::begin(const Alert& alert, const std::string& why, Now now) {
  const RobotRecord* robot = situation_.fleet().find(alert.robot);
  if (robot == nullptr) return;
  std::set<std::string> over;
  for (const Fault& fault : robot->faults) {
    const bool is_reported = is_reported_broken(*robot, fault.capability) || is_reported_broken(*robot, "");
    if (takes_away(fault) && concerns(alert, fault) && !is_reported) over.insert(fault.capability);
  }
  for (const std::string& capability : over) situation_.fleet().end_faults(alert.robot, capability, why, now.utc);
  situation_.note_robot(alert.robot, now);
}

std::vector<std::string> Repairs::still_broken(const Alert& alert) const {
  const RobotRecord* robot = situation_.fleet().find(alert.robot);
  if (robot == nullptr) return {};
  std::set<std::string> out;
  for (const Fault& fault : robot->faults) {
    if (takes_away(fault) && concerns(alert, fault) && is_reported_broken(*robot, fault.capability)) {
      out.insert(fault.capability);
    }
  }
  return {out.begin(), out.end()};
}

/// Empty: the repair has not failed.
std::string Repairs::why_failed(const RepairReport& repair, const std::vector<std::string>& broken, Now now) {
  if (repair.is_done()) return "is broken again: " + quoted(broken);
  const auto refusal = repair.refusal(now);
  return refusal ? "does not take it into use: " + *refusal : std::string();
}

bool Repairs::is_awaited(Alert& alert, Now now, Outbox& out) {
  const std::vector<std::string> broken = still_broken(alert);
  RepairReport& repair = alerts_.work(alert.id).repair;
  if (broken.empty()) {
    repair.on_done();
    return false;
  }
  if (const std::string why = why_failed(repair, broken, now); !why.empty()) {
    alerts_.reopen(alert, alert.robot + " " + why, out);
    return true;
  }
  alert.waits_for = cut_utf8(alert.robot + " to take " + quoted(broken) + " into use", 512);
  situation_.routes().want(now, RouteRequests::kAtOnce);
  if (!repair.is_due(now)) return true;
  repair.on_sent(now);
  command(alert, broken, out);
  return true;
}

void Repairs::command(const Alert& alert, const std::vector<std::string>& broken, Outbox& out) {
  for (const std::string& capability : broken) {
    if (&capability != &broken.front() && broken.front().empty()) break;  // the whole robot: includes all others
    out.command(alert.robot, TakeIntoUse{capability, false, cut_utf8(alert.person, 64)}, 0);
  }
}

void Repairs::on_taken(const std::string& robot, Now now) {
  for (const Alert* alert : alerts_.open()) {
    if (alert->robot == robot && alerts_.find_work(alert->id) != nullptr) alerts_.work(alert->id).repair.on_taken(now);
  }
  situation_.routes().want(now, RouteRequests::kAtOnce);
}

/// A message that was not delivered is sent again.
void Repairs::on_refused(const Nack& nack, const std::string& from, Now now, Outbox& out) {
  out.count("nacked." + nack.subtype);
  if (from != nack.target) {
    return from == situation_.node()
               ? out.log(LogLevel::warning, "not_yet", nack.subtype + " to '" + nack.target + "': " + nack.what)
               : out.count("dropped.foreign");
  }
  situation_.note_change();
  for (const Alert* alert : alerts_.open()) {
    if (alert->robot != from || alerts_.find_work(alert->id) == nullptr) continue;
    alerts_.work(alert->id).repair.on_refused(nack.what, now);
  }
  situation_.routes().want(now, RouteRequests::kAtOnce);
}

}  // namespace trb::resilience
