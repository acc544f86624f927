#include "common/drivers/c3/commands.hpp"

namespace trb::drivers {

C3Commands read_c3_commands(const VendorCommands& vendor, const Description& description, const VendorFaults& faults) {
  C3Commands out;
  out.commands = read_part("commands", vendor.commands, faults, read_c3_assignments);
  out.values = read_part("values", vendor.values, faults, read_c3_question);
  std::erase_if(out.values, [](const auto& value) { return is_c3_name(value.first); });
  auto names = read_c3_names(vendor.values, description.has_field_channel);
  if (!names) {
    faults.add("values", names.error());
  } else {
    out.names = std::move(*names);
  }
  return out;
}

}  // namespace trb::drivers
