// What commands.json must have for a driver that polls the robot's values, whatever its own notation is.
#pragma once

#include <functional>
#include <optional>
#include <string>

#include "common/base/result.hpp"
#include "common/config/transports.hpp"
#include "common/drivers/waited_values.hpp"

namespace trb::drivers {

/// "hold_s".
void read_hold_key(ObjectReader& vendor, VendorCommands& into);

class PolledCheck {
 public:
  /// Examples of such a transport's notation, for error texts.
  struct Examples {
    std::string transport;  ///< "modbus"
    std::string has;        ///< what its commands consist of: "numbers only"
    std::string value;      ///< of a value; NAME stands for its name: "GET /status /NAME"
    std::string command;    ///< what has to be added for a skill: "its assignments, for example \"running = 1\""
  };
  PolledCheck(const NodeConfig& config, const FileFaults& faults, Examples examples)
      : config_(config), faults_(faults), examples_(std::move(examples)) {}

  /// A fault of the vendor's key: "commands.stop".
  void add(const std::string& key, std::string what, std::string hint) const {
    faults_.add(config_.framework + "." + key, std::move(what), std::move(hint));
  }
  /// Checks that it has no monitor and no language.
  void check_foreign_keys() const;
  /// Checks that requests name values, and that skills have commands, and values that show their ends.
  void check_names() const;
  /// A fault of each value that the description waits for in vain. `never`: why the value is never that, with the cure.
  void check_waited(const std::function<std::optional<Error>(const WaitedValue&)>& never) const;

 private:
  void check_skill(const Skill& skill) const;
  void add_no_value(const std::string& key, const std::string& name, const std::string& why) const;

  const NodeConfig& config_;
  const FileFaults& faults_;
  Examples examples_;
};

}  // namespace trb::drivers
