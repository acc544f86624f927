#include "common/scenario/candidate_index.hpp"

#include <algorithm>
#include <set>

#include "common/base/words.hpp"
#include "common/fleet/did_you_mean.hpp"
#include "common/fleet/object_reader.hpp"
#include "common/scenario/definition.hpp"
#include "common/scenario/repeat.hpp"

namespace trb {
namespace {

constexpr std::size_t kWanted = 2;

/// It has the capabilities and the skill. The same as no obstacles, without making texts of them.
bool suits(const TaskNeed& need, const NodeProfile& profile) {
  const auto has = [&](const std::string& capability) { return contains(profile.capabilities, capability); };
  return std::ranges::all_of(need.capabilities, has) && takes_task(need, profile);
}

void add_parameters(const TaskNeed& need, const SkillInfo& skill, const std::string& robot, const NodeProfile& profile,
                    std::vector<Obstacle>& out) {
  for (const auto& [info, value, misfit] : parameter_faults(need, skill, profile.places)) {
    const std::string key = "data." + info.name;
    if (value == nullptr) {
      out.push_back({key, "is missing: " + in_quotes(skill.name) + " needs it", "add " + wanted_text(info)});
    } else {
      out.push_back({key, misfit_text(misfit, info, *value, robot), misfit_cure(misfit, info, *value, profile.places)});
    }
  }
  std::vector<std::string> names;
  for (const ParameterInfo& info : skill.parameters) names.push_back(info.name);
  const std::string otherwise = names.empty() ? "remove it: the skill has none" : "use one of";
  for (const std::string_view name : unknown_parameters(need, skill)) {
    out.push_back({"data." + std::string(name), in_quotes(skill.name) + " has no such parameter",
                   did_you_mean(std::string(name), names, otherwise)});
  }
}

/// Everything that a task requires of a robot.
std::string key_of(const Task& task) {
  std::string out = task.skill + '\n' + task.data;
  for (const std::string& capability : task.requires_) out += '\n' + capability;
  for (const ValueFrom& from : task.values) out += "\n=" + from.parameter;
  return out;
}

std::string in_words(const std::string& robot, const Obstacle& obstacle) {
  if (!obstacle.key.starts_with("data.")) return obstacle.what;
  return in_quotes(robot) + ": " + obstacle.key.substr(5) + " " + obstacle.what;
}

std::string why_no_spare(const Task& task, const Able& able, const std::string& robot) {
  if (task.pinned && !robot.empty()) return "it is pinned to its robot";
  if (task.pinned && !able.ready.empty()) return "it stays with the robot that is chosen for it: it is pinned";
  const std::string reasons = able.reasons(robot);
  return reasons.empty() ? "no other robot has the skill " + in_quotes(task.skill) : reasons;
}

}  // namespace

std::vector<Obstacle> obstacles(const TaskNeed& need, const std::string& robot, const NodeProfile& profile) {
  std::vector<Obstacle> out;
  for (const std::string& capability : need.capabilities) {
    if (contains(profile.capabilities, capability)) continue;
    out.push_back({"requires", in_quotes(robot) + " has no capability " + in_quotes(capability),
                   did_you_mean(capability, profile.capabilities, "use another robot, or remove it; it has")});
  }
  if (const SkillInfo* skill = find_skill(profile, need.skill)) {
    add_parameters(need, *skill, robot, profile, out);
    return out;
  }
  std::vector<std::string> names;
  for (const SkillInfo& info : profile.skills) names.push_back(info.name);
  const std::string otherwise =
      names.empty() ? "use another robot: this node has none, or its robot has no skills" : "use one of";
  out.push_back({"skill", in_quotes(robot) + " has no skill " + in_quotes(need.skill),
                 did_you_mean(need.skill, names, otherwise)});
  return out;
}

std::string why_not_ready(const NodeProfile& profile) {
  if (profile.robot.empty()) return "has no robot that tells its state";
  if (profile.robot != "ONLINE") return "is " + profile.robot;
  if (profile.fenced) return "is stopped until it is released";
  for (const OutOfUse& kept : profile.out_of_use) {
    if (kept.retired) return "is retired by " + kept.by + ": " + kept.text;
    if (kept.capability.empty()) return "is out of use: " + kept.text;
  }
  return "";
}

std::string why_not_ready(const Task& task, const NodeProfile& profile) {
  std::string why = why_not_ready(profile);
  if (!why.empty() || profile.out_of_use.empty()) return why;
  const SkillInfo* skill = find_skill(profile, task.skill);
  for (const OutOfUse& kept : profile.out_of_use) {
    const bool needed =
        (skill != nullptr && skill->capability == kept.capability) || contains(task.requires_, kept.capability);
    if (needed) return "cannot use " + in_quotes(kept.capability) + ": " + kept.text;
  }
  return "";
}

void warn_of_robots(const Scenario& scenario, const Profiles& profiles, const std::string& file, ConfigFaults& faults) {
  std::set<std::string> told;
  for (std::size_t i = 0; i < scenario.tasks.size(); ++i) {
    const Task& task = scenario.tasks[i];
    const auto at = profiles.find(task.robot);
    if (at == profiles.end() || at->second.robot.empty()) continue;
    const std::string why = why_not_ready(task, at->second);
    if (why.empty() || !told.insert(task.robot + why).second) continue;
    if (faults.size() >= kMaxWarnings) return;
    faults.push_back({file, "tasks[" + std::to_string(i) + "].robot",
                      "task " + in_quotes(task.id) + ": " + in_quotes(task.robot) + " " + why,
                      "the run waits for it; see: trb robot list", true});
  }
}

std::string Able::reasons(const std::string& except) const {
  std::string out;
  for (const auto* list : {&waiting, &unable}) {
    for (const Reason& reason : *list) {
      if (reason.robot != except) out += (out.empty() ? "" : "; ") + reason.text;
    }
  }
  return out;
}

CandidateIndex::CandidateIndex(const Profiles& profiles) : profiles_(profiles) {
  for (const Robot& robot : profiles_) {
    for (const SkillInfo& skill : robot.second.skills) {
      auto& robots = by_skill_[skill.name];
      if (robots.empty() || robots.back() != &robot) robots.push_back(&robot);
    }
  }
}

const std::vector<const CandidateIndex::Robot*>& CandidateIndex::robots_with(const std::string& skill) const {
  static const std::vector<const Robot*> kNobody;
  const auto robots = by_skill_.find(skill);
  return robots == by_skill_.end() ? kNobody : robots->second;
}

const Able& CandidateIndex::able(const Task& task) {
  const auto [at, is_new] = known_.try_emplace(key_of(task));
  Able& out = at->second;
  if (!is_new) return out;
  const auto need = need_of(task);
  if (!need) return out;
  for (const Robot* robot : robots_with(task.skill)) {
    const auto& [id, profile] = *robot;
    if (!suits(*need, profile)) {
      if (out.unable.size() == Able::kMaxTold) continue;
      out.unable.push_back({id, in_words(id, obstacles(*need, id, profile).at(0))});
    } else if (const std::string why = why_not_ready(task, profile); !why.empty()) {
      if (out.waiting.size() < Able::kMaxTold) out.waiting.push_back({id, in_quotes(id) + " " + why});
    } else {
      out.ready.push_back(id);
    }
    if (out.ready.size() == kWanted) break;
  }
  return out;
}

const std::vector<std::string>& CandidateIndex::everybody(const Task& task) {
  const auto [at, is_new] = everybody_.try_emplace(key_of(task));
  if (!is_new) return at->second;
  const auto need = need_of(task);
  if (!need) return at->second;
  for (const Robot* robot : robots_with(task.skill)) {
    const auto& [id, profile] = *robot;
    if (suits(*need, profile) && why_not_ready(task, profile).empty()) at->second.push_back(id);
  }
  return at->second;
}

std::vector<std::string> CandidateIndex::skills() const {
  std::vector<std::string> out;
  for (const auto& [skill, robots] : by_skill_) out.emplace_back(skill);
  return out;
}

std::vector<std::string> CandidateIndex::capabilities() const {
  std::set<std::string> all;
  for (const auto& [id, profile] : profiles_) {
    if (!profile.skills.empty()) all.insert(profile.capabilities.begin(), profile.capabilities.end());
  }
  return {all.begin(), all.end()};
}

std::vector<NoSpare> tasks_without_spare(const Scenario& scenario, CandidateIndex& candidates) {
  std::vector<NoSpare> out;
  for (const Task& task : scenario.tasks) {
    if (is_repetition(task.id)) continue;
    const Able& able = candidates.able(task);
    const bool is_open = able.ready.empty() || (task.pinned && able.ready.size() > 1);
    const std::string robot = !task.robot.empty() ? task.robot : is_open ? "" : able.ready.front();
    const auto is_other = [&](const std::string& id) { return id != robot; };
    if (!task.pinned && std::ranges::any_of(able.ready, is_other)) continue;
    out.push_back({task.id, robot, why_no_spare(task, able, robot)});
  }
  return out;
}

}  // namespace trb
