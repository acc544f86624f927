#include "services/cloud-gateway/io/skill_schemas.hpp"

#include <cmath>
#include <limits>
#include <string>
#include <vector>

namespace trb::gateway {
namespace {

Value texts(const std::vector<std::string>& list) {
  Value::List out;
  for (const std::string& one : list) out.push_back(Value{one});
  return Value{std::move(out)};
}

/// An open end is the largest double.
void add_range(Value::Object& out, const ParameterInfo& parameter) {
  if (parameter.range.size() != 2) return;
  const auto is_open = [](double end) { return std::abs(end) == std::numeric_limits<double>::max(); };
  if (!is_open(parameter.range[0])) out.emplace_back("minimum", Value{parameter.range[0]});
  if (!is_open(parameter.range[1])) out.emplace_back("maximum", Value{parameter.range[1]});
}

Value::Object number_schema(const ParameterInfo& parameter, const char* type) {
  Value::Object out{{"type", Value{type}}};
  add_range(out, parameter);
  return out;
}

Value::Object list_schema(const ParameterInfo& parameter) {
  Value::Object out{{"type", Value{"array"}}, {"items", Value{number_schema(parameter, "number")}}};
  if (parameter.count == 0) return out;
  const Value count{static_cast<std::int64_t>(parameter.count)};
  out.emplace_back("minItems", count);
  out.emplace_back("maxItems", count);
  return out;
}

Value::Object text_schema(const std::vector<std::string>& one_of) {
  Value::Object out{{"type", Value{"string"}}};
  if (!one_of.empty()) out.emplace_back("enum", texts(one_of));
  return out;
}

Value::Object type_schema(const ParameterInfo& parameter, const NodeProfile& profile) {
  if (parameter.type == "number") return number_schema(parameter, "number");
  if (parameter.type == "integer") return number_schema(parameter, "integer");
  if (parameter.type == "numbers") return list_schema(parameter);
  if (parameter.type == "bool") return {{"type", Value{"boolean"}}};
  if (parameter.type == "place") return text_schema(parameter.one_of.empty() ? profile.places : parameter.one_of);
  if (parameter.type == "text") return text_schema(parameter.one_of);
  return {};  // of a later version: anything
}

Value schema_of(const SkillInfo& skill, const NodeProfile& profile) {
  Value::Object properties;
  Value::List required;
  for (const ParameterInfo& parameter : skill.parameters) {
    Value::Object schema = type_schema(parameter, profile);
    if (!parameter.unit.empty()) schema.emplace_back("x-unit", Value{parameter.unit});
    properties.emplace_back(parameter.name, Value{std::move(schema)});
    if (parameter.required) required.push_back(Value{parameter.name});
  }
  return Value{Value::Object{{"$schema", Value{"https://json-schema.org/draft/2020-12/schema"}},
                             {"title", Value{skill.name}},
                             {"type", Value{"object"}},
                             {"properties", Value{std::move(properties)}},
                             {"required", Value{std::move(required)}},
                             {"additionalProperties", Value{false}}}};
}

}  // namespace

Value skill_schemas(const NodeProfile& profile) {
  Value::Object out;
  for (const SkillInfo& skill : profile.skills) out.emplace_back(skill.name, schema_of(skill, profile));
  return Value{std::move(out)};
}

}  // namespace trb::gateway
