#include "common/drivers/modbus/written_bounds.hpp"

#include <algorithm>
#include <optional>

#include "common/drivers/modbus/data.hpp"
#include "common/fleet/did_you_mean.hpp"

namespace trb::drivers {
namespace {

/// The text of the data, with what `value` gives for each placeholder. None: it has none for one of them.
template <class Give>
std::optional<std::string> filled(std::string_view text, const Give& value) {
  std::string out;
  while (!text.empty()) {
    const std::size_t open = text.find('{');
    const std::size_t close = open == std::string_view::npos ? open : text.find('}', open);
    out += text.substr(0, open);
    if (close == std::string_view::npos) break;
    const auto given = value(text.substr(open + 1, close - open - 1));
    if (!given) return std::nullopt;
    out += dump_json(*given);
    text.remove_prefix(close + 1);
  }
  return out;
}

Value example_number(const Parameter& parameter) {
  if (parameter.preset && parameter.preset->is_number()) return *parameter.preset;
  return Value{parameter.minimum.value_or(parameter.maximum.value_or(1))};
}

/// What a run may give for it; none: only a run tells.
std::optional<Value> example_of(const Parameter& parameter, const Description& description) {
  if (parameter.type == ParameterType::boolean) return Value{true};
  if (parameter.type == ParameterType::numbers) {
    if (!parameter.count) return std::nullopt;
    return Value{Value::List(*parameter.count, Value{1})};
  }
  if (parameter.type == ParameterType::text) return Value{parameter.one_of.empty() ? "text" : parameter.one_of.front()};
  if (parameter.type != ParameterType::place) return example_number(parameter);
  const auto own = parameter.one_of.empty() ? description.places.end() : description.places.find(parameter.one_of[0]);
  if (own == description.places.end()) return std::nullopt;
  return own->second;
}

std::optional<std::string> example_data(const Skill& skill, const Description& description) {
  return filled(skill.data, [&](std::string_view inside) -> std::optional<Value> {
    if (inside.find('.') != std::string_view::npos) return Value{1};  // a place's coordinate
    const auto at = std::ranges::find(skill.parameters, inside, &Parameter::name);
    return at == skill.parameters.end() ? std::nullopt : example_of(*at, description);
  });
}

/// Faults of a skill whose data the command can never take. False: there is one.
bool check_data(const NodeConfig& config, const Skill& skill, const std::vector<ModbusAssignment>& writes,
                const VendorFaults& faults) {
  const auto data = example_data(skill, config.description);
  if (!data) return true;
  Status taken = modbus_takes_all(writes, *data);
  for (const ModbusAssignment& one : writes) {
    if (const auto number = modbus_data(one, *data); taken && !number) taken = number.error();
  }
  if (taken) return true;
  faults.add(
      "commands." + skill.subtype,
      "cannot take what skill " + in_quotes(skill.name) + " sends, as " + in_quotes(*data) + ": " + taken.error().what,
      "write skills." + skill.name +
          ".command.data of the description as JSON, a number or a list of as many as the command has, for "
          "example [{a}, {b}]");
  return false;
}

class BoundsCheck {
 public:
  BoundsCheck(const NodeConfig& config, const Skill& skill, const std::vector<ModbusAssignment>& writes,
              const VendorFaults& faults)
      : config_(config), skill_(skill), writes_(writes), faults_(faults) {}

  void check(const Parameter& parameter) const {
    if (parameter.minimum) check_one(parameter, "minimum", *parameter.minimum);
    if (parameter.maximum) check_one(parameter, "maximum", *parameter.maximum);
    const bool preset = parameter.preset && parameter.preset->is_number();
    if (preset && !parameter.minimum && !parameter.maximum) check_one(parameter, "default", parameter.preset->number());
  }

 private:
  /// The data with that parameter's value, and null for all others.
  [[nodiscard]] std::string data_with(const Parameter& parameter, const Value& value) const {
    const auto give = [&](std::string_view inside) {
      return std::optional(inside == parameter.name ? value : Value{});
    };
    return filled(skill_.data, give).value_or("");
  }

  void check_one(const Parameter& parameter, const std::string& key, double bound) const {
    const double sent = bound * config_.description.frame.factor_of(parameter.unit);
    Value value{sent};
    if (parameter.type == ParameterType::numbers) value = Value{Value::List(parameter.count.value_or(1), Value{sent})};
    const std::string data = data_with(parameter, value);
    const std::string without = data_with(parameter, Value{});
    for (const ModbusAssignment& one : writes_) {
      const auto written = modbus_data(one, data);
      // What does not come from this parameter is the same without it.
      if (!written || modbus_data(one, without)) continue;
      const Status held = modbus_holds(one.place, *written);
      if (held) continue;
      faults_.add("commands." + skill_.subtype,
                  "writes " + in_quotes(one.name) + ", and \"" + key + "\" of parameter " + in_quotes(parameter.name) +
                      " of skill " + in_quotes(skill_.name) + " goes beyond it: " + held.error().what,
                  held.error().hint + " as \"" + key + "\" in the description, or another type or factor to the value");
      return;
    }
  }

  const NodeConfig& config_;
  const Skill& skill_;
  const std::vector<ModbusAssignment>& writes_;
  const VendorFaults& faults_;
};

}  // namespace

void check_written_bounds(const NodeConfig& config, const ModbusCommands& commands, const VendorFaults& faults) {
  for (const Skill& skill : config.description.skills) {
    const auto writes = commands.commands.find(skill.subtype);
    if (writes == commands.commands.end()) continue;
    if (!check_data(config, skill, writes->second, faults)) continue;
    const BoundsCheck check(config, skill, writes->second, faults);
    for (const Parameter& parameter : skill.parameters) check.check(parameter);
  }
}

}  // namespace trb::drivers
