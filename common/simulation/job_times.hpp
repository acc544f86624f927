// How long the skills of a simulated fleet take, as a job says it.
#pragma once

#include <map>
#include <string>
#include <vector>

#include "common/fleet/object_reader.hpp"
#include "common/simulation/skill_time.hpp"
#include "proto/bodies/run.hpp"

namespace trb::simulation {

constexpr std::size_t kMaxTimes = 1000;
constexpr double kMaxUntil = 7 * 24 * 3600;  ///< seconds

/// Keys `task_seconds` (3) and `deviation` (0), optional: of skills without a time of their own.
SkillTime read_usual_time(ObjectReader& reader);

/// Key `times`, optional: {SKILL: seconds, or {"mean", "deviation", "result"}}; of one task "task:ID". Every fault is
/// added, by its key.
std::map<std::string, SkillTime> read_times(ObjectReader& reader);

/// Is it a skill of the scenario's tasks, or "task:" and the id of one?
bool is_time_of(const std::string& name, const Scenario& scenario);

/// A fault for each name that is neither a skill of the scenario's tasks nor "task:" and the id of one: it would change
/// nothing, and nobody would notice. So for each task whose value another takes, if it has no `result`: the run would
/// stop there.
void check_times(const std::map<std::string, SkillTime>& times, const Scenario& scenario, const FileFaults& faults);
/// The same of scenarios that are played at once: a time is of all that have its skill or task. One that none has is
/// told with the first.
void check_times(const std::map<std::string, SkillTime>& times, const std::vector<const Scenario*>& scenarios,
                 const FileFaults& faults);

}  // namespace trb::simulation
