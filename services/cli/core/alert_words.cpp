#include "services/cli/core/alert_words.hpp"

#include <algorithm>
#include <cstdio>

#include "services/cli/core/table.hpp"

namespace trb::cli {
namespace {

std::string shown(double number, const char* format) {
  char out[32];
  std::snprintf(out, sizeof out, format, number);
  return out;
}

/// Somebody can take its tasks over.
bool has_ways(const Alert& alert) {
  return !alert.run.empty() && alert.cause != "double_execution" && alert.cause != "run_ends";
}

/// A part has a number in any case; only the proposal's note says that nobody has measured it. Of several robots it
/// names whose, "ROBOT: ", before the first word about each.
bool is_known(const Proposal& proposal, const CriterionPart& part) {
  const std::string word = part.criterion + " is not known";
  std::string robot = proposal.robot;
  for (std::size_t begin = 0; begin < proposal.note.size();) {
    const std::size_t end = std::min(proposal.note.find("; ", begin), proposal.note.size());
    std::string said = proposal.note.substr(begin, end - begin);
    begin = end + 2;
    const auto named = std::ranges::find_if(
        proposal.tasks, [&](const TaskForRobot& one) { return said.starts_with(one.robot + ": "); });
    if (named != proposal.tasks.end()) {
      robot = named->robot;
      said.erase(0, robot.size() + 2);
    }
    if (robot == part.robot && (said == word || said.starts_with(word + ","))) return false;
  }
  return true;
}

}  // namespace

std::string lost_of(const Alert& alert) {
  for (const char* whole : {"peer_expired", "robot_connection", "robot_fault", "robot_retired"}) {
    if (alert.cause == whole && alert.capability.empty()) return "all of it";
  }
  return or_dash(alert.capability);
}

std::string hold_text(const Alert& alert, UtcTime now) {
  if (!has_ways(alert)) return "";
  const bool expired = alert.state == AlertState::expired || alert.expires <= now.ns;
  return "policy: " + alert.policy +
         (expired ? "; proposals have expired, and are made anew when one is accepted"
                  : "; proposals hold until " + to_iso8601({alert.expires}));
}

std::string part_text(const Proposal& proposal, const CriterionPart& part) {
  const bool several = proposal.robot.empty() && !part.robot.empty();
  const std::string value =
      is_known(proposal, part) ? shown(part.value, "%.4g") + (part.unit.empty() ? "" : " " + part.unit) : "not known";
  return (several ? part.robot + " " : "") + part.criterion + " " + value + " (" + shown(part.contribution, "%.3f") +
         ")";
}

}  // namespace trb::cli
