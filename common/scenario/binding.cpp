// Who gets a task that names no robot: the decider, or a robot at once.
#include <algorithm>
#include <set>

#include "common/fleet/did_you_mean.hpp"
#include "common/fleet/object_reader.hpp"
#include "common/scenario/candidate_index.hpp"
#include "common/scenario/graph.hpp"
#include "common/scenario/repeat.hpp"

namespace trb {
namespace {

/// The least number of tasks that are done one after the other before each.
std::vector<std::size_t> depths_of(const Scenario& scenario) {
  const auto successors = successors_of(scenario);
  std::vector<std::size_t> open(scenario.tasks.size());
  std::vector<std::size_t> depths(scenario.tasks.size(), 0);
  std::vector<std::size_t> free;
  for (std::size_t i = 0; i < open.size(); ++i) {
    open[i] = scenario.tasks[i].after.size();
    if (open[i] == 0) free.push_back(i);
  }
  for (std::size_t taken = 0; taken < free.size(); ++taken) {
    for (const TaskIndex next : successors[free[taken]]) {
      depths[next] = std::max(depths[next], depths[free[taken]] + 1);
      if (--open[next] == 0) free.push_back(next);
    }
  }
  return depths;
}

/// The tasks that the decider binds: see bind_tasks.
std::vector<std::size_t> left_to_decider(const Scenario& scenario, CandidateIndex& candidates) {
  std::vector<std::size_t> out;
  for (std::size_t i = 0; i < scenario.tasks.size(); ++i) {
    if (scenario.tasks[i].robot.empty()) out.push_back(i);
  }
  if (out.size() <= kMaxBoundWhenDue) return out;
  const std::vector<std::size_t> depths = depths_of(scenario);
  const auto gain = [&](std::size_t i) {
    const std::size_t ready = candidates.able(scenario.tasks[i]).ready.size();
    return std::pair(ready == 0 ? 2 : ready > 1 ? 1 : 0, depths[i]);
  };
  std::stable_sort(out.begin(), out.end(), [&](std::size_t a, std::size_t b) { return gain(a) > gain(b); });
  out.resize(kMaxBoundWhenDue);
  return out;
}

const std::string* least_loaded(const std::vector<std::string>& robots,
                                const std::map<std::string, std::size_t>& load) {
  const auto load_of = [&](const std::string& robot) {
    const auto at = load.find(robot);
    return at == load.end() ? std::size_t{0} : at->second;
  };
  const std::string* least = nullptr;
  for (const std::string& robot : robots) {
    if (least == nullptr || load_of(robot) < load_of(*least)) least = &robot;
  }
  return least;
}

}  // namespace

std::vector<std::string> bind_tasks(const Scenario& scenario, CandidateIndex& candidates, const std::string& decider,
                                    const std::string& file, ConfigFaults& faults) {
  std::vector<std::string> out;
  std::map<std::string, std::size_t> load;
  for (const Task& task : scenario.tasks) {
    out.push_back(task.robot);
    if (!task.robot.empty()) ++load[task.robot];
  }
  if (!decider.empty()) {
    for (const std::size_t i : left_to_decider(scenario, candidates)) out[i] = decider;
  }
  std::set<std::string> told;
  const FileFaults sink(file, faults);
  for (std::size_t i = 0; i < scenario.tasks.size(); ++i) {
    const Task& task = scenario.tasks[i];
    if (!out[i].empty()) continue;
    if (const std::string* robot = least_loaded(candidates.everybody(task), load)) {
      out[i] = *robot;
      ++load[*robot];
    } else if (told.insert(first_id(task.id)).second) {  // a task of a later round is not reported again
      sink.add("tasks[" + std::to_string(i) + "].requires",
               "task " + in_quotes(task.id) + ": nobody can do it now: " + candidates.able(task).reasons(),
               "bring such a robot online, or name one; see: trb robot list");
    }
  }
  return out;
}

}  // namespace trb
