#include "common/drivers/modbus/data.hpp"

#include <algorithm>

#include "common/fleet/did_you_mean.hpp"
#include "proto/value.hpp"
#include "proto/value_words.hpp"

namespace trb::drivers {
namespace {

constexpr const char* kWhatItTakes = "give a number, true or false, or a list of them such as [0.25, 1]";

std::string in_items(std::size_t count) {
  return std::to_string(count) + (count == 1 ? " item" : " items");
}

Result<double> number_of(const Value& value, const std::string& name) {
  if (value.is_number()) return value.number();
  if (value.is_bool()) return value.boolean() ? 1.0 : 0.0;
  const std::string shown = value.is_text() ? " " + in_quotes(value.text()) : "";
  return fail(Errc::bad_value,
              name + ": the data holds " + in_words(value) + shown + ", and Modbus carries numbers only", kWhatItTakes);
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
  const std::string number = "{" + std::to_string(item) + "}";
  return fail(Errc::bad_value,
              assignment.name +
                  (whole ? " needs one number" : " takes " + number + ", which needs " + in_items(item + 1)) +
                  ", and the data has " + in_items(items.size()),
              kWhatItTakes);
}

Status modbus_takes_all(const std::vector<ModbusAssignment>& writes, BytesView data) {
  int last = ModbusAssignment::kLiteral;
  for (const ModbusAssignment& one : writes) last = std::max(last, one.item);
  const auto json = parse_json(data);
  if (last < 0 || !json || !json->is_list()) return Done{};
  const std::size_t taken = static_cast<std::size_t>(last) + 1;
  if (json->list().size() <= taken) return Done{};
  return fail(Errc::bad_value,
              "the command takes " + in_items(taken) + ", and the data has " + in_items(json->list().size()),
              "leave the others out, or write {" + std::to_string(taken) + "} into the command, too");
}

}  // namespace trb::drivers
