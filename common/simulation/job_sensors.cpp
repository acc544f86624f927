#include "common/simulation/job_sensors.hpp"

#include <algorithm>

#include "common/base/sensor_name.hpp"
#include "common/scenario/condition.hpp"
#include "common/simulation/job_times.hpp"
#include "proto/travel.hpp"

namespace trb::simulation {
namespace {

constexpr const char* kKey = "sensor_values";
constexpr std::size_t kMaxText = 255;
constexpr std::size_t kMaxUnit = 16;
constexpr std::size_t kMaxIdentity = 128;
constexpr Range kPeriod{0.01, 3600};
constexpr Range kNumbers{-1e12, 1e12};
constexpr Range kTimes{0, kMaxUntil};

Measured measured_of(const ObjectReader& reader, const Value& value) {
  if (value.is_number() && kNumbers.holds(value.number())) return value.number();
  if (value.is_number()) {
    reader.faults().add(reader.path("value"), "is too large", "write a number from -1e12 to 1e12");
    return {};
  }
  if (value.is_text() && value.text().size() <= kMaxText) return value.text();
  if (value.is_text()) {
    reader.faults().add(reader.path("value"), "is too long", "write a text of 255 bytes at most");
    return {};
  }
  if (!value.is_null()) {
    reader.faults().add(reader.path("value"), "is no value", "write a number, a text, or null: it cannot be read");
  }
  return {};
}

Course read_steps(const ObjectReader& of, const Value::List& list) {
  std::vector<Course::Step> steps;
  for (std::size_t i = 0; i < list.size(); ++i) {
    ObjectReader one(list[i], of.path("steps") + "[" + std::to_string(i) + "]", of.faults());
    Course::Step step;
    step.at_s = one.number("at", Need::required, kTimes).value_or(0);
    if (const Value* value = one.value("value", Need::required)) step.value = measured_of(one, *value);
    one.refuse_unknown_keys();
    if (!steps.empty() && step.at_s <= steps.back().at_s)
      of.faults().add(one.path("at"), "is not after the step before it", "write the steps in order of time");
    steps.push_back(std::move(step));
  }
  if (steps.empty()) of.faults().add(of.path("steps"), "there is none", "write at least one");
  return Course(std::move(steps));
}

Course read_ramp(const ObjectReader& of, const Value& json) {
  ObjectReader reader(json, of.path("ramp"), of.faults());
  const double from = reader.number("from", Need::required, kNumbers).value_or(0);
  const double to = reader.number("to", Need::required, kNumbers).value_or(0);
  const double begin = reader.number("begin", Need::optional, kTimes).value_or(0);
  const double end = reader.number("end", Need::required, kTimes).value_or(begin + 1);
  reader.refuse_unknown_keys();
  if (end <= begin) of.faults().add(reader.path("end"), "is not after its begin", "write a later time, in seconds");
  return Course::ramp(from, to, begin, end);
}

Course read_course(ObjectReader& reader) {
  const Value* value = reader.value("value", Need::optional);
  const Value::List* steps = reader.list("steps", Need::optional, kMaxSteps);
  const Value* ramp = reader.value("ramp", Need::optional);
  if ((value != nullptr) + (steps != nullptr) + (ramp != nullptr) != 1) {
    reader.faults().add(reader.path("value"), "one of value, steps and ramp says what it tells", "write exactly one");
    return {};
  }
  if (steps != nullptr) return read_steps(reader, *steps);
  return ramp != nullptr ? read_ramp(reader, *ramp) : Course({{0, measured_of(reader, *value)}});
}

/// As the node's profile has it, if it has one of that name.
SensorInfo known_info(const JobNodes& nodes, const std::string& node, const std::string& name) {
  SensorInfo out;
  out.name = out.kind = name;
  const NodeProfile* profile = nodes.profile(node);
  if (profile == nullptr) return out;
  const auto at = std::ranges::find(profile->plugged, name, &SensorInfo::name);
  return at == profile->plugged.end() ? out : *at;
}

void check_name(const ObjectReader& reader, const PlannedSensors& before, const PlannedSensor& sensor) {
  const std::string& name = sensor.info.name;
  const auto refuse = [&](const std::string& what, const char* hint) {
    reader.faults().add(reader.path("name"), "'" + name + "' " + what, hint);
  };
  if (!is_sensor_name(name)) return refuse("is no sensor's name", "use letters, digits and _; no digit first");
  if (is_reserved(name)) return refuse("is a word of the middleware's", "give it another name");
  const bool is_taken = std::ranges::any_of(
      before, [&](const PlannedSensor& other) { return other.node == sensor.node && other.info.name == name; });
  if (is_taken) refuse("is there twice at that node", "give each its own name");
}

void read_sensor(ObjectReader& reader, const JobNodes& nodes, PlannedSensors& sensors) {
  PlannedSensor out;
  out.node = reader.text("node", Need::required, kMaxId).value_or(kCloud);
  nodes.check(reader, "node", out.node);
  const std::string name = reader.text("name", Need::required, kMaxId).value_or("x");
  out.info = known_info(nodes, out.node, name);
  out.info.kind = reader.text("kind", Need::optional, kMaxId).value_or(out.info.kind);
  out.info.unit = reader.text("unit", Need::optional, kMaxUnit).value_or(out.info.unit);
  out.info.identity = reader.text("identity", Need::optional, kMaxIdentity).value_or(out.info.identity);
  out.info.state = SensorState::ok;
  out.every_s = reader.number("every_s", Need::optional, kPeriod).value_or(out.every_s);
  out.course = read_course(reader);
  reader.refuse_unknown_keys();
  check_name(reader, sensors, out);
  sensors.push_back(std::move(out));
}

bool is_meant(const PlannedSensor& sensor, const Condition& condition) {
  const bool here = condition.of.empty() || !condition.identity.empty() || condition.of == sensor.node;
  return here && find_sensor({sensor.info}, condition) != nullptr;
}

void check_condition(const PlannedSensors& sensors, const Task& task, const Condition& condition,
                     const FileFaults& faults, const std::string& key) {
  const auto fault = [&](const std::string& what, const std::string& hint) {
    faults.add(key, "task '" + task.id + "' waits for " + sensor_text(condition) + ", " + what, hint);
  };
  std::string units;
  bool is_other = false;
  for (const PlannedSensor& one : sensors) {
    if (!is_meant(one, condition)) continue;
    const bool fits = one.course.tells(condition.is_text);
    if (fits && (condition.is_text || one.info.unit == condition.unit)) return;
    is_other = is_other || !fits;
    units += " '" + one.info.unit + "'";
  }
  if (is_other && condition.is_text) return fault("a text, but it tells a number", R"(write a text: "value": "00123")");
  if (is_other) return fault("a number, but it tells a text", R"(write a number: "value": 20.5)");
  if (units.empty())
    return fault("which tells nothing here", R"(add to sensor_values: {"node", "name", "unit", "value"})");
  fault("whose unit is" + units, "give it the unit '" + condition.unit + "' in sensor_values");
}

}  // namespace

PlannedSensors read_sensor_values(ObjectReader& reader, const JobNodes& nodes, std::size_t most) {
  PlannedSensors out;
  const Value::List* list = reader.list(kKey, Need::optional, most);
  for (std::size_t i = 0; list != nullptr && i < list->size(); ++i) {
    ObjectReader one((*list)[i], std::string(kKey) + "[" + std::to_string(i) + "]", reader.faults());
    read_sensor(one, nodes, out);
  }
  return out;
}

void plug_in(const PlannedSensors& sensors, std::map<std::string, NodeProfile>& profiles) {
  for (const PlannedSensor& sensor : sensors) {
    const auto at = profiles.find(sensor.node);
    if (at == profiles.end()) continue;
    auto& plugged = at->second.plugged;
    std::erase_if(plugged, [&](const SensorInfo& other) { return other.name == sensor.info.name; });
    plugged.push_back(sensor.info);
  }
}

std::map<std::string, NodeProfile> with_cloud(std::map<std::string, NodeProfile> robots,
                                              const PlannedSensors& sensors) {
  robots[kCloud] = {};
  plug_in(sensors, robots);
  return robots;
}

void check_conditions(const PlannedSensors& sensors, const Scenario& scenario, const FileFaults& faults,
                      const std::string& key) {
  for (const Task& task : scenario.tasks) {
    for (const Condition& condition : task.when) check_condition(sensors, task, condition, faults, key);
  }
}

}  // namespace trb::simulation
