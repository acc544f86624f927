#include "services/resilience/core/candidates.hpp"

#include <algorithm>
#include <set>

#include "common/base/words.hpp"

namespace trb::resilience {
namespace {

constexpr std::size_t kMaxName = 40;  ///< bytes of a parameter's name, which comes from outside
constexpr std::size_t kMostReasons = 4;
constexpr std::size_t kMostTasks = 3;  ///< that a reason names
/// A run may have a thousand tasks: after so many that it cannot do no more are looked at.
constexpr std::size_t kMostUnable = 16;

/// What a robot lacks, and for which of the tasks; none: for all.
struct Reason {
  std::string what;
  std::vector<std::string> tasks;
};

void add_words(const TaskNeed& need, std::set<std::string>& words) {
  if (!need.skill.empty()) words.insert(skill_word(need.skill));
  for (const std::string& capability : need.capabilities) words.insert(capability_word(capability));
}

std::vector<RobotNumber> ask(const FleetIndex& index, std::set<std::string> words) {
  words.emplace(kFitWord);
  const std::vector<std::string> list(words.begin(), words.end());
  std::vector<RobotNumber> out;
  index.query(list, out);
  return out;
}

/// For a robot that has the capabilities and the skill.
bool suits(const RobotRecord& robot, const TaskNeed& need) {
  return !contains(need.tried, robot.id) && takes_task(need, robot.profile.is);
}

std::string of_parameter(std::string_view name, const std::string& what) {
  return "parameter '" + cut_utf8(name, kMaxName) + "': " + what;
}

/// The first parameter that does not fit, for a person: "parameter 'speed': 3 is over 1 m/s"; empty: all fit.
std::string why_misfit(const RobotRecord& robot, const TaskNeed& need, const SkillInfo& skill) {
  const auto unknown = unknown_parameters(need, skill);
  if (!unknown.empty()) return of_parameter(unknown.front(), "its skill has none of that name");
  const auto faults = parameter_faults(need, skill, robot.profile.is.places);
  if (faults.empty()) return {};
  const auto& [info, value, misfit] = faults.front();
  return of_parameter(info.name,
                      value == nullptr ? "it is required here" : misfit_text(misfit, info, *value, robot.id));
}

std::string lacks_capability(const RobotRecord& robot, const std::string& capability) {
  if (is_able(robot, capability)) return {};
  if (!contains(robot.profile.is.capabilities, capability)) return "has no capability '" + capability + "'";
  const Fault* fault = fault_of(robot, capability);
  if (fault == nullptr) return "'" + capability + "': its sensor tells nothing";
  return "'" + capability + "' is broken since " + to_iso8601(fault->since) + ": " + fault->text;
}

/// Does the robot have part of what is needed? People will ask why it was not taken.
bool is_near(const RobotRecord& robot, const Needs& needs) {
  return std::ranges::any_of(needs.tasks, [&](const TaskNeed& need) {
    if (!need.skill.empty() && find_skill(robot, need.skill) != nullptr) return true;
    return std::ranges::any_of(need.capabilities, [&](const std::string& capability) {
      return contains(robot.profile.is.capabilities, capability);
    });
  });
}

/// What several tasks lack is one reason.
void add_reason(std::vector<Reason>& reasons, const std::string& what, const std::string& task) {
  if (what.empty()) return;
  auto at = std::ranges::find(reasons, what, &Reason::what);
  if (at == reasons.end()) {
    if (reasons.size() >= kMostReasons) return;
    at = reasons.insert(at, {what, {}});
  }
  if (!task.empty()) at->tasks.push_back(task);
}

/// "it does not turn (tasks a, b)"
std::string text_of(const Reason& reason) {
  const std::size_t count = reason.tasks.size();
  if (count == 0) return reason.what;
  const std::vector<std::string> named(reason.tasks.begin(),
                                       reason.tasks.begin() + static_cast<std::ptrdiff_t>(std::min(count, kMostTasks)));
  return reason.what + (count == 1 ? " (task " : " (tasks ") + joined(named) +
         (count > kMostTasks ? " and others)" : ")");
}

/// Behind a word, if there is one near, and it says that it is cut.
std::string cut_words(const std::string& text, std::size_t most) {
  constexpr std::string_view kCut = "…";
  if (text.size() <= most) return text;
  std::string out = cut_utf8(text, most - kCut.size());
  const std::size_t space = out.rfind(' ');
  if (space != std::string::npos && space > most / 4) out.resize(space + 1);
  return out + std::string(kCut);
}

std::string why_not(const RobotRecord& robot, const Needs& needs) {
  std::vector<Reason> reasons;
  add_reason(reasons, why_unfit(robot), "");
  std::size_t unable = 0;
  for (const TaskNeed& need : needs.tasks) {
    if (contains(need.tried, robot.id)) add_reason(reasons, "has failed task '" + need.task + "' already", "");
    const std::string why = why_unable(robot, need);
    add_reason(reasons, why, need.task);
    if (!why.empty() && ++unable >= kMostUnable) break;
    if (reasons.size() >= kMostReasons) break;
  }
  std::string out;
  for (const Reason& reason : reasons) out += (out.empty() ? "" : "; ") + text_of(reason);
  return cut_words(out, kMaxWhy);
}

void explain(const Fleet& fleet, const Needs& needs, Candidates& out) {
  for (const auto& [id, robot] : fleet.robots()) {
    if (std::binary_search(out.robots.begin(), out.robots.end(), id) || contains(needs.except, id)) continue;
    if (out.unsuitable.size() >= kMaxUnsuitable || !is_near(robot, needs)) {
      ++out.others;
      continue;
    }
    out.unsuitable.push_back({id, why_not(robot, needs)});
  }
}

}  // namespace

bool Candidates::cover() const {
  if (!robots.empty()) return true;
  return !by_task.empty() &&
         std::ranges::none_of(by_task, [](const TaskCandidates& task) { return task.robots.empty(); });
}

std::string why_unable(const RobotRecord& robot, const TaskNeed& need) {
  for (const std::string& capability : need.capabilities) {
    if (auto why = lacks_capability(robot, capability); !why.empty()) return why;
  }
  if (need.skill.empty()) return {};
  const SkillInfo* skill = find_skill(robot, need.skill);
  if (skill == nullptr) return "has no skill '" + need.skill + "'";
  if (!skill->capability.empty()) {
    if (auto why = lacks_capability(robot, skill->capability); !why.empty()) return why;
  }
  return why_misfit(robot, need, *skill);
}

std::vector<std::string> find_able(const Fleet& fleet, const std::vector<TaskNeed>& needs,
                                   const std::vector<std::string>& except) {
  std::set<std::string> words;
  for (const TaskNeed& need : needs) add_words(need, words);
  std::vector<std::string> out;
  for (const RobotNumber number : ask(fleet.index(), std::move(words))) {
    const std::string& id = fleet.index().id_of(number);
    const RobotRecord& robot = fleet.record(number);
    const auto suits_it = [&](const TaskNeed& need) { return suits(robot, need); };
    if (!contains(except, id) && std::ranges::all_of(needs, suits_it)) out.push_back(id);
  }
  std::sort(out.begin(), out.end());
  return out;
}

Candidates find_candidates(const Fleet& fleet, const Needs& needs) {
  Candidates out;
  out.robots = find_able(fleet, needs.tasks, needs.except);
  if (out.robots.empty()) {
    for (const TaskNeed& need : needs.tasks) {
      out.by_task.push_back({need.task, find_able(fleet, {need}, needs.except)});
    }
  }
  explain(fleet, needs, out);
  return out;
}

}  // namespace trb::resilience
