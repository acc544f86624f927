// ResilienceCore: a person says that a robot is repaired; its node is told, and has the last word.
#include <algorithm>

#include "proto/value.hpp"
#include "services/resilience/core/resilience_core.hpp"

namespace trb::resilience {
namespace {

/// Within this time the node's new profile has come by way of the routers.
constexpr Duration kProfile = std::chrono::seconds(3);
constexpr Duration kTellAgain = std::chrono::seconds(10);

std::string quoted(const std::vector<std::string>& capabilities) {
  std::string out;
  for (const std::string& one : capabilities)
    out += (out.empty() ? "" : ", ") + (one.empty() ? "itself" : "'" + one + "'");
  return out;
}

/// The alert's word on a repair speaks of that fault.
bool speaks_of(const Alert& alert, const Fault& fault) {
  return alert.capability.empty() || fault.capability.empty() || fault.capability == alert.capability;
}

}  // namespace

/// What only this node knows of is over at once; the rest when the robot's node says so.
void ResilienceCore::mend(const Alert& alert, const std::string& why, Now now) {
  const RobotRecord* robot = fleet_.find(alert.robot);
  if (robot == nullptr) return;
  std::set<std::string> over;
  for (const Fault& fault : robot->faults) {
    const bool is_told = is_told_broken(*robot, fault.capability) || is_told_broken(*robot, "");
    if (takes_away(fault) && speaks_of(alert, fault) && !is_told) {
      over.insert(fault.capability);
    }
  }
  for (const std::string& capability : over) fleet_.end_faults(alert.robot, capability, why, now.utc);
  look_at_robot(alert.robot, now);
}

/// Capabilities of which a person has said that they are repaired, and that the robot's node still has as broken.
std::vector<std::string> ResilienceCore::told_broken(const Alert& alert) const {
  const RobotRecord* robot = fleet_.find(alert.robot);
  std::set<std::string> out;
  if (robot == nullptr) return {};
  for (const Fault& fault : robot->faults) {
    if (takes_away(fault) && speaks_of(alert, fault) && is_told_broken(*robot, fault.capability)) {
      out.insert(fault.capability);
    }
  }
  return {out.begin(), out.end()};
}

/// True: the robot's node has not taken it into use yet, and is told again.
bool ResilienceCore::waits_for_mending(Alert& alert, Now now, Outbox& out) {
  const std::vector<std::string> broken = told_broken(alert);
  Work& work = works_[alert.id];
  if (broken.empty()) {
    work.mended = true;
    return false;
  }
  if (work.mended) {
    unmended(alert, "is broken again: " + quoted(broken), out);
    return true;
  }
  if (work.refused_at && now.mono - *work.refused_at >= kProfile) {
    unmended(alert, "does not take it into use: " + work.refusal_to_mend, out);
    return true;
  }
  alert.waits_for = cut_utf8(alert.robot + " to take " + quoted(broken) + " into use", 512);
  ask_routes(now, std::chrono::seconds(1));
  const bool answered = work.refused_at || (work.taken_at && now.mono - *work.taken_at < kTellAgain);
  if (answered || !work.mend.due(now.mono)) return true;
  work.mend.said(now.mono);
  work.taken_at.reset();
  for (const std::string& capability : broken) {
    if (&capability != &broken.front() && broken.front().empty()) break;  // the whole robot: that is all of them
    out.command(alert.robot, TakeIntoUse{capability, false, cut_utf8(alert.person, 64)}, 0);
  }
  return true;
}

/// Its profile is on its way.
void ResilienceCore::hear_taken(const std::string& from, Now now) {
  for (const Alert* alert : book_.open()) {
    const auto at = works_.find(alert->id);
    if (alert->robot == from && at != works_.end() && at->second.mend.next()) at->second.taken_at = now.mono;
  }
  ask_routes(now, std::chrono::seconds(1));
}

/// The robot's own node refuses: for good, if its profile does not tell soon that the answer was only late. What was
/// not delivered is said again.
void ResilienceCore::hear_unmended(const Nack& nack, const std::string& from, Now now, Outbox& out) {
  out.count("nacked." + nack.subtype);
  if (from != nack.target) {
    return from == settings_.node
               ? out.log(LogLevel::warning, "not_yet", nack.subtype + " to '" + nack.target + "': " + nack.what)
               : out.count("dropped.foreign");
  }
  stirred_ = true;
  for (const Alert* alert : book_.open()) {
    const auto at = works_.find(alert->id);
    if (alert->robot != from || at == works_.end()) continue;
    Work& work = at->second;
    if (!work.mend.next() || work.mended || work.taken_at || work.refused_at) continue;
    work.refused_at = now.mono;
    work.refusal_to_mend = nack.what;
  }
  ask_routes(now, std::chrono::seconds(1));
}

/// The alert is open again, and says why.
void ResilienceCore::unmended(Alert& alert, const std::string& why, Outbox& out) {
  reopen(alert, alert.robot + " " + why, out);
}

}  // namespace trb::resilience
