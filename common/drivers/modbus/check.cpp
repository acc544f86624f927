// What the transport modbus requires of commands.json.
#include "common/config/transports.hpp"
#include "common/drivers/modbus/commands.hpp"
#include "common/drivers/modbus/written_bounds.hpp"
#include "common/drivers/polled_check.hpp"
#include "common/drivers/text/number_text.hpp"

namespace trb::drivers {
namespace {

constexpr int kMostUnits = 247;
constexpr Range kPoll{0.005, 1, false};
constexpr Range kTimeout{0.05, 2, false};

/// A coil is true or false, as 1 or 0, a register a number; neither is ever a text.
std::optional<Error> never(const VendorCommands& vendor, const WaitedValue& one) {
  const auto words = vendor.values.find(one.name);
  if (words == vendor.values.end()) return std::nullopt;
  const auto place = read_modbus_place(words->second);
  if (!place) return std::nullopt;  // that is a fault of its own
  const bool bit = place->type == ModbusType::boolean;
  if (one.wanted.is_text()) {
    return fail(Errc::bad_value, to_text(*place) + (bit ? " is true or false" : " is a number"),
                bit ? "write true or false there, without quotes" : "write a number there, without quotes");
  }
  const double number = one.wanted.is_bool() ? double(one.wanted.boolean()) : one.wanted.number();
  if (Status held = modbus_has(*place, number); !held) return held.error();
  return std::nullopt;
}

/// A limit that the register never passes.
void check_limits(const NodeConfig& config, const ModbusPlaces& values, const VendorFaults& faults) {
  for (const FaultRule& rule : config.description.faults) {
    const bool above = rule.when == FaultWhen::above;
    if (!above && rule.when != FaultWhen::below) continue;
    const auto request = config.commands.requests.find(rule.value);
    const std::string& name = request == config.commands.requests.end() ? rule.value : request->second;
    const auto place = values.find(name);
    if (place == values.end()) continue;
    const Status passes = modbus_passes(place->second, rule.limit, above);
    if (passes) continue;
    const std::string key = above ? "above" : "below";
    faults.add("values." + name,
               "is never " + key + " " + number_text(rule.limit) + ", for which faults." + rule.name + "." + key +
                   " of the description waits: " + passes.error().what,
               passes.error().hint);
  }
}

}  // namespace

void read_modbus_keys(ObjectReader& vendor, VendorCommands& into) {
  // Devices without a serial line behind them often have the address 255.
  const auto unit = vendor.integer("unit", Need::optional, 0, 255);
  if (unit && *unit > kMostUnits && *unit != 255) {
    vendor.faults().add(vendor.path("unit"), std::to_string(*unit) + " is no unit", "use 0 to 247, or 255");
  }
  if (unit) into.numbers["unit"] = static_cast<double>(*unit);
  if (const auto poll_s = vendor.number("poll_s", Need::optional, kPoll)) into.numbers["poll_s"] = *poll_s;
  if (const auto timeout_s = vendor.number("timeout_s", Need::optional, kTimeout))
    into.numbers["timeout_s"] = *timeout_s;
  read_hold_key(vendor, into);
}

ModbusSettings modbus_settings(const VendorCommands& vendor) {
  ModbusSettings settings;
  const auto number = [&](const char* key, double preset) {
    const auto at = vendor.numbers.find(key);
    return at == vendor.numbers.end() ? preset : at->second;
  };
  settings.unit = static_cast<int>(number("unit", settings.unit));
  settings.poll_s = number("poll_s", settings.poll_s);
  settings.timeout_s = number("timeout_s", settings.timeout_s);
  return settings;
}

void check_modbus(const NodeConfig& config, const FileFaults& faults) {
  const VendorCommands& vendor = config.commands;
  const VendorFaults vendor_faults(config.framework, faults);
  const PolledCheck check(config, faults,
                          {"modbus", "numbers only", "discrete 0", R"(its assignments, for example "running = 1")"});
  check.check_foreign_keys();
  ModbusPlaces values = read_modbus_values(vendor, vendor_faults);
  check_words(vendor, config.framework, faults);
  const ModbusCommands commands = read_modbus_commands(vendor, std::move(values), vendor_faults);
  check.check_names();
  check_written_bounds(config, commands, vendor_faults);
  check_limits(config, commands.values, vendor_faults);
  check.check_waited([&](const WaitedValue& one) { return never(vendor, one); });
}

}  // namespace trb::drivers
