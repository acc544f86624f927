// The robot's values: the faults and the news that the description makes of them.
#include "common/drivers/lines/field_text.hpp"
#include "services/mode-adapter/core/adapter_core.hpp"

namespace trb::adapter {
namespace {

/// What a robot tells in fields is JSON, or words that become a text of it.
RobotValue value_in_fields(BytesView data, Now now) {
  const auto json = parse_json(data);
  return {read_numbers(data).value_or(std::vector<double>()),
          json ? std::string(data) : dump_json(Value{std::string(data)}), now.mono};
}

}  // namespace

void ModeAdapterCore::watch(const Driver& mode, Now now, Outbox& out) {
  const Description& description = robot_.settings.description;
  FaultNews news;
  for (const FaultRule& rule : description.faults) {
    if (const RobotValue* value = mode.value(rule.value)) faults_.on_value(rule.value, *value, now, news);
  }
  for (const std::string& name : description.sensors) {
    if (const RobotValue* value = mode.value(name)) sensors_.on_value(name, *value);
  }
  tell_watched(news, now, out);
}

void ModeAdapterCore::watch_field(const Said& said, Now now, Outbox& out) {
  const RobotValue value = value_in_fields(said.data, now);
  FaultNews news;
  faults_.on_value(said.subtype, value, now, news);
  sensors_.on_value(said.subtype, value);
  tell_watched(news, now, out);
}

void ModeAdapterCore::tick_watch(Now now, Outbox& out) {
  FaultNews news;
  faults_.tick(now, news);
  tell_watched(news, now, out);
}

void ModeAdapterCore::tell_watched(const FaultNews& news, Now now, Outbox& out) {
  for (const FaultOver& over : news.over) on_over(over, now, out);
  for (const FaultSaid& fault : news.said) on_fault(fault, now, out);
  sensors_.tick(now, out);
}

}  // namespace trb::adapter
