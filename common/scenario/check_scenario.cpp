#include <set>

#include "common/base/words.hpp"
#include "common/fleet/did_you_mean.hpp"
#include "common/fleet/object_reader.hpp"
#include "common/scenario/candidate_index.hpp"
#include "common/scenario/condition_file.hpp"
#include "common/scenario/definition.hpp"
#include "common/scenario/repeat.hpp"

namespace trb {
namespace {

/// Checks one task; `path_` is its place in the file.
class TaskCheck {
 public:
  TaskCheck(const Task& task, std::string path, const Profiles& profiles, CandidateIndex& candidates, FileFaults faults)
      : task_(task), path_(std::move(path)), profiles_(profiles), candidates_(candidates), faults_(std::move(faults)) {}

  void run() {
    if (task_.robot.empty()) return bound_late();
    const auto at = profiles_.find(task_.robot);
    if (at == profiles_.end()) return unknown_robot();
    const auto data = parameters_of(task_);
    if (!data) return add({"data", data.error().what, data.error().hint});
    for (Obstacle& obstacle : obstacles(need_of(task_, *data), at->first, at->second)) add(std::move(obstacle));
  }

 private:
  void add(Obstacle obstacle) const {
    faults_.add(path_ + "." + obstacle.key, "task " + in_quotes(task_.id) + ": " + obstacle.what,
                std::move(obstacle.hint));
  }

  void unknown_robot() const {
    if (faults_.full()) return;
    std::vector<std::string> ids;
    for (const auto& [id, profile] : profiles_) {
      if (!profile.skills.empty()) ids.push_back(id);
    }
    add({"robot", in_quotes(task_.robot) + " is no robot of the fleet",
         ids.empty() ? "start the robots' nodes first, or correct the id"
                     : did_you_mean(task_.robot, ids, "start its node, or use one of")});
  }

  /// Some robot of the fleet must be able; whether it is ready is checked only when the run begins.
  void bound_late() const {
    const auto data = parameters_of(task_);
    if (!data) return add({"data", data.error().what, data.error().hint});
    const Able& able = candidates_.able(task_);
    if (faults_.full() || !able.ready.empty() || !able.waiting.empty()) return;
    bool told = unknown_word("skill", task_.skill, candidates_.skills());
    for (const std::string& capability : task_.requires_) {
      told = unknown_word("requires", capability, candidates_.capabilities()) || told;
    }
    if (told) return;
    add({"requires", "no robot of the fleet can do it: " + able.reasons(),
         "start the node of one that can, or change what the task asks"});
  }

  bool unknown_word(const std::string& key, const std::string& word, const std::vector<std::string>& known) const {
    if (contains(known, word)) return false;
    const std::string what = key == "skill" ? "skill " : "capability ";
    add({key, "no robot of the fleet has the " + what + in_quotes(word),
         known.empty() ? "start the robots' nodes first" : did_you_mean(word, known, "use one of")});
    return true;
  }

  const Task& task_;
  std::string path_;
  const Profiles& profiles_;
  CandidateIndex& candidates_;
  FileFaults faults_;
};

/// The tasks' places in the file that have faults of their own, but for what they wait for.
std::set<std::string> misread_tasks(const ConfigFaults& faults) {
  std::set<std::string> out;
  for (const ConfigFault& fault : faults) {
    const auto end = fault.key.find(']');
    if (end == std::string::npos || fault.may_wait || fault.key.substr(end + 1) == ".after") continue;
    out.insert(fault.key.substr(0, end + 1));
  }
  return out;
}

}  // namespace

void check_scenario(const Scenario& scenario, const std::map<std::string, NodeProfile>& profiles,
                    const std::string& file, ConfigFaults& faults) {
  CandidateIndex candidates(profiles);
  const std::set<std::string> misread = misread_tasks(faults);
  for (std::size_t i = 0; i < scenario.tasks.size(); ++i) {
    const Task& task = scenario.tasks[i];
    if (is_repetition(task.id)) continue;
    const std::string path = "tasks[" + std::to_string(i) + "]";
    if (misread.contains(path)) continue;  // what follows from its faults would be told as well
    TaskCheck(task, path, profiles, candidates, FileFaults(file, faults)).run();
    for (const Condition& condition : task.when) check_condition(condition, profiles, path + ".when", file, faults);
  }
}

}  // namespace trb
