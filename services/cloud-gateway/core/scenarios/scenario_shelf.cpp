#include "services/cloud-gateway/core/scenarios/scenario_shelf.hpp"

#include "common/base/hex.hpp"
#include "proto/bodies/run.hpp"
#include "proto/value.hpp"

namespace trb::gateway {
namespace {

constexpr std::size_t kIdBytes = 8;
constexpr std::size_t kMaxName = 64;

Error no_scenario() {
  return fail(Errc::missing, "there is no such scenario", "GET /api/v1/scenarios");
}

Result<std::string> name_in(const Value& json) {
  const Value* name = json.find("name");
  if (name == nullptr) return fail(Errc::missing, "name: is missing", "give the scenario a name");
  if (name->is_text() && !name->text().empty() && name->text().size() <= kMaxName) return name->text();
  return fail(Errc::bad_value, "name: is no name", "write 1 to " + std::to_string(kMaxName) + " bytes of text");
}

Result<std::uint32_t> tasks_in(const Value& json) {
  const Value* tasks = json.find("tasks");
  if (tasks == nullptr) return fail(Errc::missing, "tasks: is missing", "write a list; it may be empty");
  if (!tasks->is_list()) return fail(Errc::bad_value, "tasks: is no list", "write a list of tasks");
  if (tasks->list().size() > kMaxTasks) {
    return fail(Errc::too_large, "tasks: " + std::to_string(tasks->list().size()) + " of them",
                "use at most " + std::to_string(kMaxTasks));
  }
  for (std::size_t i = 0; i < tasks->list().size(); ++i) {
    if (tasks->list()[i].is_object()) continue;
    return fail(Errc::bad_value, "tasks[" + std::to_string(i) + "]: is no object",
                R"(write {"id": ..., "skill": ...})");
  }
  return static_cast<std::uint32_t>(tasks->list().size());
}

}  // namespace

Result<ScenarioText> read_draft(Bytes text) {
  if (text.size() > kMaxScenarioSize) {
    return fail(Errc::too_large, "the scenario has " + std::to_string(text.size()) + " bytes",
                "use at most " + std::to_string(kMaxScenarioSize));
  }
  const auto json = parse_json(text);
  if (!json) return json.error();
  if (!json->is_object())
    return fail(Errc::bad_value, "the scenario is no object", R"(write {"name": ..., "tasks": []})");
  auto name = name_in(*json);
  if (!name) return name.error();
  const auto tasks = tasks_in(*json);
  if (!tasks) return tasks.error();
  return ScenarioText{std::move(text), std::move(*name), *tasks};
}

void ScenarioShelf::restore(StoredScenario scenario) {
  size_ += scenario.scenario.text.size();
  std::string id = scenario.id;
  scenarios_.emplace(std::move(id), std::move(scenario));
}

Status ScenarioShelf::check_room(const ScenarioText& scenario, std::size_t instead_of) const {
  if (size_ - instead_of + scenario.text.size() <= kMaxScenarioSizes) return Done{};
  return fail(Errc::queue_full, "the stored scenarios have " + std::to_string(size_) + " bytes", "delete some");
}

const StoredScenario* ScenarioShelf::put(StoredScenario scenario) {
  changes_.put(scenario.id, scenario);
  StoredScenario& kept = scenarios_[scenario.id];
  size_ += scenario.scenario.text.size() - kept.scenario.text.size();
  kept = std::move(scenario);
  return &kept;
}

Result<const StoredScenario*> ScenarioShelf::add(ScenarioText scenario, std::string by, UtcTime now) {
  if (scenarios_.size() >= kMaxScenarios) {
    return fail(Errc::queue_full, "there are " + std::to_string(kMaxScenarios) + " scenarios", "delete some");
  }
  if (Status room = check_room(scenario, 0); !room) return room.error();
  return put({to_hex(random_(kIdBytes)), std::move(scenario), 1, std::move(by), now});
}

Result<const StoredScenario*> ScenarioShelf::change(const std::string& id, ScenarioText scenario, std::string by,
                                                    UtcTime now) {
  const StoredScenario* before = find(id);
  if (before == nullptr) return no_scenario();
  if (Status room = check_room(scenario, before->scenario.text.size()); !room) return room.error();
  return put({id, std::move(scenario), before->version + 1, std::move(by), now});
}

Status ScenarioShelf::remove(const std::string& id) {
  const auto at = scenarios_.find(id);
  if (at == scenarios_.end()) return no_scenario();
  size_ -= at->second.scenario.text.size();
  changes_.drop(id);  // first: the id may be the row's own
  scenarios_.erase(at);
  return Done{};
}

const StoredScenario* ScenarioShelf::find(const std::string& id) const {
  const auto at = scenarios_.find(id);
  return at == scenarios_.end() ? nullptr : &at->second;
}

}  // namespace trb::gateway
