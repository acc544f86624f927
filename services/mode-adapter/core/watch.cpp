// The robot's values: the faults and the news that the description makes of them.
#include "services/mode-adapter/core/adapter_core.hpp"
#include "services/mode-adapter/core/field/field_words.hpp"

namespace trb::adapter {
namespace {

/// What a robot tells in fields is JSON, or words that become a text of it.
RobotValue value_in_fields(BytesView data, Now now) {
  const auto json = parse_json(data);
  return {read_numbers(data).value_or(std::vector<double>()),
          json ? std::string(data) : dump_json(Value{std::string(data)}), now.mono};
}

}  // namespace

void ModeAdapterCore::watch(const RobotMode& mode, Now now, Outbox& out) {
  const Description& description = robot_.settings.description;
  std::vector<FaultSaid> told;
  for (const FaultRule& rule : description.faults) {
    if (const RobotValue* value = mode.value(rule.value)) faults_.on_value(rule.value, *value, now, told);
  }
  for (const std::string& name : description.sensors) {
    if (const RobotValue* value = mode.value(name)) sensors_.on_value(name, *value);
  }
  tell_watched(told, now, out);
}

void ModeAdapterCore::watch_field(const Said& said, Now now, Outbox& out) {
  const RobotValue value = value_in_fields(said.data, now);
  std::vector<FaultSaid> told;
  faults_.on_value(said.subtype, value, now, told);
  sensors_.on_value(said.subtype, value);
  tell_watched(told, now, out);
}

void ModeAdapterCore::tick_watch(Now now, Outbox& out) {
  std::vector<FaultSaid> told;
  faults_.tick(now, told);
  tell_watched(told, now, out);
}

void ModeAdapterCore::tell_watched(const std::vector<FaultSaid>& told, Now now, Outbox& out) {
  for (const FaultSaid& fault : told) on_fault(fault, now, out);
  sensors_.tick(now, out);
}

}  // namespace trb::adapter
