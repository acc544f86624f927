#include <algorithm>
#include <array>

#include "common/base/ids.hpp"
#include "common/fleet/description_parts.hpp"
#include "common/fleet/did_you_mean.hpp"

namespace trb {
namespace {

constexpr std::size_t kMaxWords = 64;
constexpr std::int64_t kMaxCount = 64;
constexpr std::array<std::string_view, 9> kVendorUnits = {"mm",      "cm", "inch",  "deg", "degree",
                                                          "degrees", "°",  "deg/s", "mm/s"};

bool is_numeric(ParameterType type) {
  return type == ParameterType::number || type == ParameterType::integer || type == ParameterType::numbers;
}

bool is_named(ParameterType type) {
  return type == ParameterType::text || type == ParameterType::place;
}

void read_unit(ObjectReader& reader, Parameter& parameter) {
  parameter.unit = reader.text("unit", Need::optional, 16).value_or("");
  if (std::find(kVendorUnits.begin(), kVendorUnits.end(), parameter.unit) == kVendorUnits.end()) return;
  reader.faults().add(reader.path("unit"), in_quotes(parameter.unit) + " is no SI unit",
                      "give parameters in m, rad, s and so on; \"frame\" turns them into the robot's units");
}

void read_bounds(ObjectReader& reader, Parameter& parameter) {
  parameter.minimum = reader.number("minimum", Need::optional);
  parameter.maximum = reader.number("maximum", Need::optional);
  if (parameter.minimum && parameter.maximum && *parameter.minimum > *parameter.maximum) {
    reader.faults().add(reader.path("minimum"), "is more than \"maximum\"", "swap them");
  }
}

bool in_bounds(const Parameter& parameter, double number) {
  return (!parameter.minimum || number >= *parameter.minimum) && (!parameter.maximum || number <= *parameter.maximum);
}

bool is_number_in_bounds(const Parameter& parameter, const Value& value) {
  return value.is_number() && in_bounds(parameter, value.number());
}

bool is_allowed_word(const Parameter& parameter, const Value& value) {
  const auto& words = parameter.one_of;
  return value.is_text() && (words.empty() || std::find(words.begin(), words.end(), value.text()) != words.end());
}

bool are_numbers(const Parameter& parameter, const Value& value) {
  if (!value.is_list() || (parameter.count && value.list().size() != *parameter.count)) return false;
  return std::all_of(value.list().begin(), value.list().end(),
                     [&](const Value& item) { return is_number_in_bounds(parameter, item); });
}

bool fits(const Parameter& parameter, const Value& value) {
  switch (parameter.type) {
    case ParameterType::number:
      return is_number_in_bounds(parameter, value);
    case ParameterType::integer:
      return value.is_integer() && is_number_in_bounds(parameter, value);
    case ParameterType::text:
    case ParameterType::place:
      return is_allowed_word(parameter, value);
    case ParameterType::boolean:
      return value.is_bool();
    case ParameterType::numbers:
      return are_numbers(parameter, value);
  }
  return false;
}

/// A parameter with a default is optional, unless "required" says otherwise; then the default is a mistake.
void read_preset(ObjectReader& reader, Parameter& parameter) {
  const Value* preset = reader.value("default", Need::optional);
  parameter.required = reader.boolean("required", Need::optional).value_or(preset == nullptr);
  if (preset == nullptr) return;
  parameter.preset = *preset;
  if (parameter.required) {
    reader.faults().add(reader.path("default"), "a required parameter has no default",
                        "remove \"default\", or set \"required\" to false");
  } else if (!fits(parameter, *preset)) {
    reader.faults().add(reader.path("default"), "does not fit the parameter's own type and bounds",
                        "use a " + std::string(name_of(parameter.type)) + " that the other keys allow");
  }
}

}  // namespace

Parameter read_parameter(const std::string& name, const Value& json, const std::string& path,
                         const FileFaults& faults) {
  ObjectReader reader(json, path, faults);
  Parameter parameter;
  parameter.name = name;
  if (!is_valid_word(name))
    faults.add(path, in_quotes(name) + " is no name", "start with a letter; then letters, digits, _");
  const auto type = reader.one_of<ParameterType>("type", Need::required);
  parameter.type = type.value_or(ParameterType::text);
  // Which keys are known depends on the type, so that "minimum" of a text is refused, not ignored.
  if (!type || is_numeric(*type)) {
    read_unit(reader, parameter);
    read_bounds(reader, parameter);
  }
  if (!type || is_named(*type)) parameter.one_of = reader.texts("one_of", Need::optional, kMaxWords);
  if (!type || *type == ParameterType::numbers) {
    const auto count = reader.integer("count", Need::optional, 1, kMaxCount);
    if (count) parameter.count = static_cast<std::size_t>(*count);
  }
  if (type) {
    read_preset(reader, parameter);
    reader.refuse_unknown_keys();
  }
  return parameter;
}

}  // namespace trb
