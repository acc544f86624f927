// What the transport modbus asks of commands.json.
#include "common/config/transports.hpp"
#include "common/drivers/modbus/syntax.hpp"
#include "common/drivers/polled_check.hpp"

namespace trb::drivers {
namespace {

constexpr int kMostUnits = 247;
constexpr Range kPoll{0.005, 1, false};
constexpr Range kTimeout{0.05, 2, false};

/// One vendor's part of commands.json.
class Checker {
 public:
  Checker(const NodeConfig& config, const FileFaults& faults)
      : config_(config),
        vendor_(config.commands),
        faults_(faults),
        check_(config, faults,
               {"modbus", "numbers only", "discrete 0", R"(its assignments, for example "running = 1")"}) {}

  void check() {
    check_.check_foreign_keys();
    values();
    check_words(vendor_, config_.framework, faults_);
    for (const auto& [subtype, words] : vendor_.commands) command(subtype, words);
    check_.check_names();
  }

 private:
  void values() {
    for (const auto& [name, words] : vendor_.values) {
      const auto place = read_modbus_place(words);
      if (!place) check_.add("values." + name, place.error().what, place.error().hint);
      places_[name] = place ? *place : ModbusPlace{};  // a bad place counts as given: one mistake, one fault
    }
  }

  void command(const std::string& subtype, const std::string& words) const {
    const auto read = read_modbus_assignments(words, places_);
    if (!read) return check_.add("commands." + subtype, read.error().what, read.error().hint);
    if (read->empty() && !words.empty())
      check_.add("commands." + subtype, "is blank", "write NAME = NUMBER, a line each");
    if (subtype != "stop" && subtype != "release") return;
    for (const ModbusAssignment& one : *read) {
      if (one.item == ModbusAssignment::kLiteral) continue;
      check_.add("commands." + subtype, "needs data for '" + one.name + "', and a " + subtype + " has none",
                 "write the number itself, for example " + one.name + " = 0");
    }
  }

  const NodeConfig& config_;
  const VendorCommands& vendor_;
  const FileFaults& faults_;
  PolledCheck check_;
  ModbusPlaces places_;
};

}  // namespace

void read_modbus_keys(ObjectReader& vendor, VendorCommands& into) {
  // 255 is what devices without a serial line behind them are often addressed by.
  const auto unit = vendor.integer("unit", Need::optional, 0, 255);
  if (unit && *unit > kMostUnits && *unit != 255) {
    vendor.faults().add(vendor.path("unit"), std::to_string(*unit) + " is no unit", "use 0 to 247, or 255");
  }
  if (unit) into.numbers["unit"] = static_cast<double>(*unit);
  if (const auto poll_s = vendor.number("poll_s", Need::optional, kPoll)) into.numbers["poll_s"] = *poll_s;
  if (const auto timeout_s = vendor.number("timeout_s", Need::optional, kTimeout))
    into.numbers["timeout_s"] = *timeout_s;
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
  Checker(config, faults).check();
}

}  // namespace trb::drivers
