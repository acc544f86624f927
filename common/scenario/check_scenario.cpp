#include <algorithm>

#include "common/fleet/did_you_mean.hpp"
#include "common/fleet/object_reader.hpp"
#include "common/scenario/condition_file.hpp"
#include "common/scenario/definition.hpp"

namespace trb {
namespace {

using Profiles = std::map<std::string, NodeProfile>;

bool contains(const std::vector<std::string>& words, const std::string& word) {
  return std::find(words.begin(), words.end(), word) != words.end();
}

/// Checks one task; `path_` is where it stands in the file.
class TaskCheck {
 public:
  TaskCheck(const Task& task, std::string path, const Profiles& profiles, FileFaults faults)
      : task_(task), path_(std::move(path)), profiles_(profiles), faults_(std::move(faults)) {}

  void run() {
    const auto at = profiles_.find(task_.robot);
    if (at == profiles_.end()) return unknown_robot();
    robot_ = &at->second;
    const auto& skills = robot_->skills;
    const auto skill =
        std::find_if(skills.begin(), skills.end(), [&](const SkillInfo& info) { return info.name == task_.skill; });
    if (skill == skills.end()) return unknown_skill();
    parameters(*skill);
  }

 private:
  void add(const std::string& key, const std::string& what, std::string cure) const {
    faults_.add(path_ + "." + key, "task " + in_quotes(task_.id) + ": " + what, std::move(cure));
  }

  void unknown_robot() const {
    std::vector<std::string> ids;
    for (const auto& [id, profile] : profiles_) {
      if (!profile.skills.empty()) ids.push_back(id);
    }
    add("robot", in_quotes(task_.robot) + " is no robot of the fleet",
        ids.empty() ? "start the robots' nodes first, or correct the id"
                    : did_you_mean(task_.robot, ids, "start its node, or use one of"));
  }

  void unknown_skill() const {
    std::vector<std::string> names;
    for (const SkillInfo& info : robot_->skills) names.push_back(info.name);
    const std::string otherwise =
        names.empty() ? "use another robot: this node has none, or its robot has no skills" : "use one of";
    add("skill", in_quotes(task_.robot) + " has no skill " + in_quotes(task_.skill),
        did_you_mean(task_.skill, names, otherwise));
  }

  void parameters(const SkillInfo& skill) const {
    Value data{Value::Object{}};
    if (!task_.data.empty()) {
      auto parsed = parse_json(task_.data);
      if (!parsed || !parsed->is_object()) {
        return add("data", "is no JSON object", R"(write the skill's parameters as { "NAME": VALUE, … })");
      }
      data = std::move(*parsed);
    }
    std::vector<std::string> names;
    for (const ParameterInfo& info : skill.parameters) {
      names.push_back(info.name);
      parameter(info, data.find(info.name));
    }
    for (const auto& [name, ignored] : data.object()) {
      if (contains(names, name)) continue;
      add("data." + name, in_quotes(skill.name) + " has no such parameter",
          did_you_mean(name, names, names.empty() ? "remove it: the skill has none" : "use one of"));
    }
  }

  void parameter(const ParameterInfo& info, const Value* value) const {
    if (value == nullptr) {
      if (!info.required) return;
      return add("data." + info.name, "is missing: " + in_quotes(task_.skill) + " needs it", "add " + wanted(info));
    }
    if (!fits(info.type, *value)) {
      return add("data." + info.name, "is a " + std::string(value->kind()), "use " + wanted(info));
    }
    if (info.type == "place" && !contains(robot_->places, value->text())) {
      add("data." + info.name, in_quotes(value->text()) + " is no place that " + in_quotes(task_.robot) + " knows",
          did_you_mean(value->text(), robot_->places, "add it to places.json of its node, or use one of"));
    }
  }

  static bool fits(const std::string& type, const Value& value) {
    if (type == "number") return value.is_number();
    if (type == "integer") return value.is_integer();
    if (type == "bool") return value.is_bool();
    if (type == "text" || type == "place") return value.is_text();
    if (type != "numbers") return true;  // a type of a newer version: its node will check it
    return value.is_list() &&
           std::all_of(value.list().begin(), value.list().end(), [](const Value& item) { return item.is_number(); });
  }

  static std::string wanted(const ParameterInfo& info) {
    std::string out = "\"" + info.name + "\": ";
    if (info.type == "numbers") {
      out += "a list of numbers";
    } else if (info.type == "bool") {
      out += "true or false";
    } else if (info.type == "place") {
      out += "the name of a place, in quotes";
    } else if (info.type == "integer") {
      out += "a whole number";
    } else {
      out += "a " + info.type;
    }
    return info.unit.empty() ? out : out + " in " + info.unit;
  }

  const Task& task_;
  std::string path_;
  const Profiles& profiles_;
  FileFaults faults_;
  const NodeProfile* robot_ = nullptr;
};

}  // namespace

void check_scenario(const Scenario& scenario, const std::map<std::string, NodeProfile>& profiles,
                    const std::string& file, ConfigFaults& faults) {
  for (std::size_t i = 0; i < scenario.tasks.size(); ++i) {
    const std::string path = "tasks[" + std::to_string(i) + "]";
    TaskCheck(scenario.tasks[i], path, profiles, FileFaults(file, faults)).run();
    for (const Condition& condition : scenario.tasks[i].when) {
      check_condition(condition, profiles, path + ".when", file, faults);
    }
  }
}

}  // namespace trb
