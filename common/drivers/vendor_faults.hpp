// One function of a driver reads its vendor's part of commands.json: `trb check` uses its faults, the driver its
// commands.
#pragma once

#include <functional>
#include <map>
#include <memory>
#include <string>
#include <string_view>
#include <type_traits>
#include <utility>

#include "common/drivers/driver.hpp"
#include "common/drivers/driver_settings.hpp"
#include "common/fleet/object_reader.hpp"

namespace trb::drivers {

/// Collects the faults of one vendor's part; keys are relative to its name: "commands.stop".
class VendorFaults {
 public:
  VendorFaults(std::string vendor, FileFaults faults) : vendor_(std::move(vendor)), faults_(std::move(faults)) {}

  void add(const std::string& key, std::string what, std::string hint) const {
    faults_.add(vendor_ + "." + key, std::move(what), std::move(hint));
  }
  void add(const std::string& key, const Error& error) const { add(key, error.what, error.hint); }

 private:
  std::string vendor_;
  FileFaults faults_;
};

/// The entries of `part` ("commands", "values"), each as `read` reads its words; what `read` refuses is a fault.
template <class Read>
auto read_part(std::string_view part, const std::map<std::string, std::string>& entries, const VendorFaults& faults,
               Read read) {
  std::map<std::string, std::decay_t<decltype(*read({}))>, std::less<>> out;
  for (const auto& [name, words] : entries) {
    auto one = read(words);
    if (!one) {
      faults.add(std::string(part) + "." + name, one.error());
    } else {
      out.emplace(name, std::move(*one));
    }
  }
  return out;
}

/// Makes a driver with its commands, as `kRead` parses them from commands.json: never from texts that cannot be parsed.
/// Errors: bad_value (the first fault).
template <class DriverType, auto kRead>
Result<std::unique_ptr<Driver>> make_with(const DriverSettings& settings) {
  ConfigFaults faults;
  const VendorFaults vendor(settings.commands.transport, FileFaults("commands.json", faults));
  auto commands = kRead(settings.commands, settings.description, vendor);
  if (faults.empty()) return std::unique_ptr<Driver>(std::make_unique<DriverType>(settings, std::move(commands)));
  const ConfigFault& first = faults.front();
  return fail(Errc::bad_value, first.file + ": " + first.key + ": " + first.what, first.hint);
}

}  // namespace trb::drivers
