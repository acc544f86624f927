#include "services/mode-adapter/core/robot_watch.hpp"

#include "common/drivers/lines/field_text.hpp"
#include "proto/value.hpp"

namespace trb::adapter {
namespace {

/// A value in fields is JSON, or words, which become a JSON text.
RobotValue value_in_fields(BytesView data, Now now) {
  const auto json = parse_json(data);
  return {read_numbers(data).value_or(std::vector<double>()),
          json ? std::string(data) : dump_json(Value{std::string(data)}), now.mono};
}

}  // namespace

void RobotWatch::on_values(const Driver& mode, Now now, Outbox& out) {
  faults_.on_values(mode, now, out);
  for (const std::string& name : settings_.description.sensors) {
    if (const RobotValue* value = mode.value(name)) sensors_.on_value(name, *value);
  }
  sensors_.tick(now, out);
}

void RobotWatch::on_field(const Said& said, Now now, Outbox& out) {
  const RobotValue value = value_in_fields(said.data, now);
  faults_.on_value(said.subtype, value, now, out);
  sensors_.on_value(said.subtype, value);
  sensors_.tick(now, out);
}

void RobotWatch::tick(Now now, Outbox& out) {
  faults_.tick(now, out);
  sensors_.tick(now, out);
}

std::optional<MonotonicTime> RobotWatch::next_deadline() const {
  return earlier(faults_.next_deadline(), sensors_.next_deadline());
}

}  // namespace trb::adapter
