#include "services/cli/commands/sensor_values.hpp"

namespace trb::cli {
namespace {

const SensorChannel* find_channel(const std::vector<SensorRule>& rules, const std::string& name) {
  for (const SensorRule& rule : rules) {
    for (const SensorChannel& channel : rule.channels) {
      if (channel.name == name || channel.kind == name) return &channel;
    }
  }
  return nullptr;
}

std::string text_of(const Value& entry, const char* key) {
  const Value* found = entry.find(key);
  return found != nullptr && found->is_text() ? found->text() : "";
}

void complete(Value& entry, const FolderSensors& rules) {
  const auto node = rules.find(text_of(entry, "node"));
  if (node == rules.end()) return;
  const SensorChannel* channel = find_channel(node->second, text_of(entry, "name"));
  if (channel == nullptr) return;
  const auto add = [&](const char* key, Value value) {
    if (entry.find(key) == nullptr) std::get<Value::Object>(entry.is).emplace_back(key, std::move(value));
  };
  add("kind", Value{channel->kind});
  add("unit", Value{channel->unit});
  if (channel->every_s > 0) add("every_s", Value{channel->every_s});
}

}  // namespace

Value with_rules(Value list, const FolderSensors& rules) {
  if (!list.is_list()) return list;
  for (Value& entry : std::get<Value::List>(list.is)) {
    if (entry.is_object()) complete(entry, rules);
  }
  return list;
}

}  // namespace trb::cli
