#include "common/drivers/c3/commands.hpp"

namespace trb::drivers {
namespace {

void read_values(const VendorCommands& vendor, const VendorFaults& faults, C3Commands& into) {
  for (const auto& [name, words] : vendor.values) {
    auto read = read_c3_question(words);
    if (!read) {
      faults.add("values." + name, read.error());
    } else if (!is_c3_name(name)) {
      into.values.emplace(name, std::move(*read));
    }
  }
}

}  // namespace

C3Commands read_c3_commands(const VendorCommands& vendor, const Description& description, const VendorFaults& faults) {
  C3Commands out;
  for (const auto& [subtype, words] : vendor.commands) {
    auto read = read_c3_assignments(words);
    if (!read) {
      faults.add("commands." + subtype, read.error());
    } else {
      out.commands.emplace(subtype, std::move(*read));
    }
  }
  read_values(vendor, faults, out);
  auto names = read_c3_names(vendor.values, description.has_field_channel);
  if (!names) {
    faults.add("values", names.error());
  } else {
    out.names = std::move(*names);
  }
  return out;
}

}  // namespace trb::drivers
