#include "services/mode-adapter/core/skill_parameters.hpp"

#include <algorithm>
#include <cmath>

#include "common/drivers/text/number_text.hpp"
#include "proto/value_words.hpp"
#include "services/mode-adapter/core/drivers.hpp"

namespace trb::adapter {
namespace {

Error bad(const Parameter& parameter, const std::string& what, std::string hint = {}) {
  return fail(Errc::bad_value, "parameter '" + parameter.name + "': " + what, std::move(hint));
}

Error wrong_type(const Parameter& parameter, const Value& value) {
  return bad(parameter, "is " + in_words(value) + ", not a " + std::string(name_of(parameter.type)));
}

Status check_range(const Parameter& parameter, const Value& value) {
  const double number = value.number();
  const std::string unit = parameter.unit.empty() ? "" : " " + parameter.unit;
  if (parameter.minimum && number < *parameter.minimum) {
    return bad(parameter, number_text(number) + " is under " + number_text(*parameter.minimum) + unit);
  }
  if (parameter.maximum && number > *parameter.maximum) {
    return bad(parameter, number_text(number) + " is over " + number_text(*parameter.maximum) + unit);
  }
  return Done{};
}

Status check_number(const Parameter& parameter, const Value& value) {
  if (!value.is_number()) return wrong_type(parameter, value);
  if (parameter.type == ParameterType::integer && value.number() != std::floor(value.number())) {
    return bad(parameter, number_text(value.number()) + " is no whole number");
  }
  return check_range(parameter, value);
}

Status check_word(const Parameter& parameter, const Value& value) {
  if (!value.is_text()) return wrong_type(parameter, value);
  const auto& words = parameter.one_of;
  if (words.empty() || std::find(words.begin(), words.end(), value.text()) != words.end()) return Done{};
  std::string list;
  for (const std::string& word : words) list += (list.empty() ? "" : ", ") + word;
  return bad(parameter, "'" + value.text().substr(0, 40) + "' is none of its words", "use one of: " + list);
}

Status check_numbers(const Parameter& parameter, const Value& value) {
  if (!value.is_list()) return wrong_type(parameter, value);
  if (parameter.count && value.list().size() != *parameter.count) {
    return bad(parameter,
               "has " + std::to_string(value.list().size()) + " numbers, not " + std::to_string(*parameter.count));
  }
  for (const Value& item : value.list()) {
    if (!item.is_number()) return bad(parameter, "holds " + in_words(item) + ", not only numbers");
    if (Status range = check_range(parameter, item); !range) return range;
  }
  return Done{};
}

Status check(const Parameter& parameter, const Value& value) {
  switch (parameter.type) {
    case ParameterType::number:
    case ParameterType::integer:
      return check_number(parameter, value);
    case ParameterType::text:
    case ParameterType::place:
      return check_word(parameter, value);
    case ParameterType::boolean:
      return value.is_bool() ? Status(Done{}) : Status(wrong_type(parameter, value));
    case ParameterType::numbers:
      break;
  }
  return check_numbers(parameter, value);
}

Status check_names(const Skill& skill, const Value& given) {
  for (const auto& [name, value] : given.object()) {
    const bool known = std::any_of(skill.parameters.begin(), skill.parameters.end(),
                                   [&key = name](const Parameter& parameter) { return parameter.name == key; });
    if (!known)
      return fail(Errc::unknown_key, "parameter '" + name + "': the skill '" + skill.name + "' has none of that name");
  }
  return Done{};
}

}  // namespace

Result<Arguments> read_arguments(const Skill& skill, std::string_view parameters) {
  auto given = parameters.empty() ? Result<Value>(Value{Value::Object{}}) : parse_json(parameters);
  if (!given) return given.error();
  if (!given->is_object()) return fail(Errc::malformed, "the parameters are " + in_words(*given) + ", not an object");
  if (Status names = check_names(skill, *given); !names) return names.error();
  Arguments arguments;
  for (const Parameter& parameter : skill.parameters) {
    const Value* value = given->find(parameter.name);
    if (value == nullptr && parameter.preset) value = &*parameter.preset;
    if (value == nullptr && parameter.required) {
      return fail(Errc::missing, "parameter '" + parameter.name + "': is required");
    }
    if (value == nullptr) continue;
    if (Status checked = check(parameter, *value); !checked) return checked.error();
    arguments.emplace(parameter.name, *value);
  }
  return arguments;
}

}  // namespace trb::adapter
