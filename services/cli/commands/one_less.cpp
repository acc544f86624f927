#include "services/cli/commands/one_less.hpp"

#include <utility>
#include <vector>

namespace trb::cli {
namespace {

bool is_text(const Value* value, const std::string& text) {
  return value != nullptr && value->is_text() && value->text() == text;
}

Value without_text(const Value& list, const std::string& text) {
  Value::List out;
  for (const Value& one : list.list()) {
    if (!is_text(&one, text)) out.push_back(one);
  }
  return Value{std::move(out)};
}

/// A partition has to leave somebody on each side: `robots` and the cloud are there.
bool is_partition(const Value& nodes, std::size_t robots) {
  return !nodes.list().empty() && nodes.list().size() <= robots;
}

/// A fault without the robot, or nothing.
std::vector<Value> fault_without(Value fault, const std::string& robot, std::size_t robots) {
  if (!fault.is_object()) return {std::move(fault)};
  if (is_text(fault.find("node"), robot) || is_text(fault.find("other"), robot)) return {};
  for (auto& [key, value] : std::get<Value::Object>(fault.is)) {
    if (key != "nodes" || !value.is_list()) continue;
    Value left = without_text(value, robot);
    if (left.list().size() == value.list().size()) continue;
    if (!is_partition(left, robots)) return {};
    value = std::move(left);
  }
  return {std::move(fault)};
}

Value faults_without(const Value& faults, const std::string& robot, std::size_t robots) {
  Value::List out;
  for (const Value& one : faults.list()) {
    for (Value& left : fault_without(one, robot, robots)) out.push_back(std::move(left));
  }
  return Value{std::move(out)};
}

Value sensors_without(const Value& sensors, const std::string& robot) {
  Value::List out;
  for (const Value& one : sensors.list()) {
    if (!one.is_object() || !is_text(one.find("node"), robot)) out.push_back(one);
  }
  return Value{std::move(out)};
}

}  // namespace

Value::Object without_robot(const Value::Object& job, const std::string& robot, std::size_t robots) {
  Value::Object out;
  for (const auto& [key, value] : job) {
    if (key == "trace" || key == "alone") continue;
    if (key == "faults" && value.is_list()) {
      out.emplace_back(key, faults_without(value, robot, robots));
    } else if (key == "sensor_values" && value.is_list()) {
      out.emplace_back(key, sensors_without(value, robot));
    } else if (key == "relays" && value.is_list()) {
      out.emplace_back(key, without_text(value, robot));
    } else {
      out.emplace_back(key, value);
    }
  }
  return out;
}

}  // namespace trb::cli
