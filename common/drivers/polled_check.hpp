// What commands.json must have for a driver that asks for the robot's values in a round, whatever its own syntax is.
#pragma once

#include <string>

#include "common/config/transports.hpp"

namespace trb::drivers {

class PolledCheck {
 public:
  /// How such a transport is spoken of in errors.
  struct Examples {
    std::string transport;  ///< "modbus"
    std::string has;        ///< what its commands are made of: "numbers only"
    std::string value;      ///< of a value; NAME stands for its name: "GET /status /NAME"
    std::string command;    ///< what is to be added for a skill: "its assignments, for example \"running = 1\""
  };
  PolledCheck(const NodeConfig& config, const FileFaults& faults, Examples examples)
      : config_(config), faults_(faults), examples_(std::move(examples)) {}

  /// A fault of the vendor's key: "commands.stop".
  void add(const std::string& key, std::string what, std::string hint) const {
    faults_.add(config_.framework + "." + key, std::move(what), std::move(hint));
  }
  /// It has no monitor and no language.
  void check_foreign_keys() const;
  /// That requests name values, and that skills have commands, and values by which their ends are seen.
  void check_names() const;

 private:
  void check_skill(const Skill& skill) const;
  void add_no_value(const std::string& key, const std::string& name, const std::string& why) const;

  const NodeConfig& config_;
  const FileFaults& faults_;
  Examples examples_;
};

}  // namespace trb::drivers
