#include "common/drivers/modbus/commands.hpp"

namespace trb::drivers {
namespace {

void check_data(const std::string& subtype, const std::vector<ModbusAssignment>& writes, const VendorFaults& faults) {
  if (subtype != "stop" && subtype != "release") return;
  for (const ModbusAssignment& one : writes) {
    if (one.item == ModbusAssignment::kLiteral) continue;
    faults.add("commands." + subtype, "needs data for '" + one.name + "', and a " + subtype + " has none",
               "write the number itself, for example " + one.name + " = 0");
  }
}

}  // namespace

ModbusPlaces read_modbus_values(const VendorCommands& vendor, const VendorFaults& faults) {
  ModbusPlaces places;
  for (const auto& [name, words] : vendor.values) {
    const auto place = read_modbus_place(words);
    if (!place) faults.add("values." + name, place.error());
    places[name] = place ? *place : ModbusPlace{};
  }
  return places;
}

ModbusCommands read_modbus_commands(const VendorCommands& vendor, ModbusPlaces values, const VendorFaults& faults) {
  ModbusCommands out{std::move(values), {}};
  for (const auto& [subtype, words] : vendor.commands) {
    auto read = read_modbus_assignments(words, out.values);
    if (!read) {
      faults.add("commands." + subtype, read.error());
      continue;
    }
    if (read->empty() && !words.empty()) {
      faults.add("commands." + subtype, "is blank", "write NAME = NUMBER, a line each");
    }
    check_data(subtype, *read, faults);
    out.commands.emplace(subtype, std::move(*read));
  }
  return out;
}

ModbusCommands read_modbus_vendor(const VendorCommands& vendor, const Description&, const VendorFaults& faults) {
  return read_modbus_commands(vendor, read_modbus_values(vendor, faults), faults);
}

}  // namespace trb::drivers
