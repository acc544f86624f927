#include "common/drivers/modbus/data.hpp"

#include "common/fleet/did_you_mean.hpp"
#include "proto/value.hpp"

namespace trb::drivers {
namespace {

constexpr const char* kWhatItTakes = "give a number, true or false, or a list of them such as [0.25, 1]";

Result<double> number_of(const Value& value, const std::string& name) {
  if (value.is_number()) return value.number();
  if (value.is_bool()) return value.boolean() ? 1.0 : 0.0;
  const std::string shown = value.is_text() ? " " + in_quotes(value.text()) : "";
  return fail(Errc::bad_value,
              name + ": the data holds a " + std::string(value.kind()) + shown + ", and Modbus carries numbers only",
              kWhatItTakes);
}

}  // namespace

Result<double> modbus_data(const ModbusAssignment& assignment, BytesView data) {
  if (assignment.item == ModbusAssignment::kLiteral) return assignment.literal;
  if (data.empty()) return fail(Errc::bad_value, assignment.name + " needs data, and there is none", kWhatItTakes);
  const auto json = parse_json(data);
  if (!json) return fail(Errc::bad_value, "the data is no JSON: " + json.error().what, kWhatItTakes);
  const Value::List items = json->is_list() ? json->list() : Value::List{*json};
  const bool whole = assignment.item == ModbusAssignment::kWhole;
  const auto item = static_cast<std::size_t>(whole ? 0 : assignment.item);
  if (item < items.size() && !(whole && items.size() > 1)) return number_of(items[item], assignment.name);
  return fail(Errc::bad_value,
              assignment.name + " needs " + (whole ? "one number" : "item " + std::to_string(item) + " of a list") +
                  ", and the data has " + std::to_string(items.size()) + " items",
              kWhatItTakes);
}

}  // namespace trb::drivers
