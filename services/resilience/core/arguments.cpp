#include "services/resilience/core/arguments.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>

namespace trb::resilience {
namespace {

constexpr std::size_t kMaxWord = 40;
constexpr double kWhole = 9e15;  ///< whole numbers beyond cannot be told from their neighbours

bool contains(const std::vector<std::string>& words, const std::string& word) {
  return std::find(words.begin(), words.end(), word) != words.end();
}

std::string number_text(double number) {
  char text[32];
  std::snprintf(text, sizeof text, "%.6g", number);
  return text;
}

std::string wrong_type(const ParameterInfo& info, const Value& value) {
  return "is a " + std::string(value.kind()) + ", not a " + info.type;
}

std::string number_misfit(const ParameterInfo& info, const Value& value) {
  if (!value.is_number()) return wrong_type(info, value);
  const double number = value.number();
  if (!std::isfinite(number)) return "is no finite number";
  if (info.type == "integer" && (number != std::floor(number) || std::abs(number) > kWhole)) {
    return number_text(number) + " is no whole number";
  }
  if (info.range.size() != 2) return {};
  const std::string unit = info.unit.empty() ? "" : " " + info.unit;
  if (number < info.range[0]) return number_text(number) + " is under " + number_text(info.range[0]) + unit;
  if (number > info.range[1]) return number_text(number) + " is over " + number_text(info.range[1]) + unit;
  return {};
}

std::string word_misfit(const ParameterInfo& info, const Value& value, const std::vector<std::string>& places) {
  if (!value.is_text()) return wrong_type(info, value);
  const std::string quoted = "'" + cut_utf8(value.text(), kMaxWord) + "'";
  if (info.type == "place" && !contains(places, value.text())) return quoted + " is no place that it knows";
  if (!info.one_of.empty() && !contains(info.one_of, value.text())) return quoted + " is none of its words";
  return {};
}

std::string list_misfit(const ParameterInfo& info, const Value& value) {
  if (!value.is_list()) return wrong_type(info, value);
  const std::size_t count = value.list().size();
  if (info.count != 0 && count != info.count) {
    return "has " + std::to_string(count) + " numbers, not " + std::to_string(info.count);
  }
  for (const Value& item : value.list()) {
    if (auto wrong = number_misfit(info, item); !wrong.empty()) return wrong;
  }
  return {};
}

std::string value_misfit(const ParameterInfo& info, const Value& value, const std::vector<std::string>& places) {
  if (info.type == "number" || info.type == "integer") return number_misfit(info, value);
  if (info.type == "text" || info.type == "place") return word_misfit(info, value, places);
  if (info.type == "bool") return value.is_bool() ? "" : wrong_type(info, value);
  if (info.type == "numbers") return list_misfit(info, value);
  return {};
}

const Value* given(const TaskNeed& need, const std::string& name) {
  const auto at = std::ranges::find(need.arguments, name, [](const auto& argument) { return argument.first; });
  return at == need.arguments.end() ? nullptr : &at->second;
}

std::string of_parameter(const std::string& name, const std::string& what) {
  return "parameter '" + cut_utf8(name, kMaxWord) + "': " + what;
}

}  // namespace

std::string misfit(const SkillInfo& skill, const TaskNeed& need, const std::vector<std::string>& places) {
  const auto has = [&](const std::string& name) {
    return std::ranges::find(skill.parameters, name, &ParameterInfo::name) != skill.parameters.end();
  };
  for (const auto& [name, ignored] : need.arguments) {
    if (!has(name)) return of_parameter(name, "its skill has none of that name");
  }
  for (const std::string& name : need.later) {
    if (!has(name)) return of_parameter(name, "its skill has none of that name");
  }
  for (const ParameterInfo& info : skill.parameters) {
    const Value* value = given(need, info.name);
    if (value == nullptr) {
      if (info.required && !contains(need.later, info.name)) return of_parameter(info.name, "it is required here");
      continue;
    }
    if (auto wrong = value_misfit(info, *value, places); !wrong.empty()) return of_parameter(info.name, wrong);
  }
  return {};
}

}  // namespace trb::resilience
