// What the transports require of commands.json. Each driver declares it (common/drivers); a service that talks to no
// robot knows none, and does not check the file.
#pragma once

#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "common/config/node_config.hpp"
#include "common/fleet/object_reader.hpp"

namespace trb {

struct Transport {
  std::string_view name;
  Mode mode{};  ///< the first transport of a mode is the default where commands.json names none
  /// Checks that the texts of the node's own vendor are valid, and that its skills have commands and ends that can be
  /// detected.
  void (*check)(const NodeConfig&, const FileFaults&) = nullptr;
  /// Reads the keys that only this transport has; may be null.
  void (*read)(ObjectReader& vendor, VendorCommands& into) = nullptr;
  std::vector<std::string_view> monitors{};     ///< protocols of its monitor connection
  std::vector<std::string_view> languages{};    ///< other notations for its commands, besides "plain"
  std::vector<std::string_view> wraps{};        ///< values of "wrap"
  std::vector<std::string> monitored_values{};  ///< that the monitor reports without a request
  bool names_values = true;                     ///< false: the robot names its values when it sends them
  bool takes_fields = false;  ///< what commands.json has no words for goes field by field, if the robot's program can
};

class Transports {
 public:
  Transports() = default;
  explicit Transports(std::vector<const Transport*> rows) : rows_(std::move(rows)) {}

  [[nodiscard]] bool empty() const { return rows_.empty(); }
  [[nodiscard]] const Transport* find(std::string_view name) const;
  /// The transport of a vendor without "transport" in that mode; empty if there is none.
  [[nodiscard]] std::string default_of(Mode mode) const;
  [[nodiscard]] std::vector<std::string> names() const;
  [[nodiscard]] std::string names_of(Mode mode) const;  ///< "tcp-text, modbus"
  /// "plain" or "", and what the transports add.
  [[nodiscard]] std::vector<std::string> all_of(std::vector<std::string_view> Transport::*list,
                                                std::vector<std::string> first) const;
  /// Checks that the node's own vendor has what its transport needs, and that the transport belongs to the node's mode.
  void check(const NodeConfig& config, const FileFaults& faults) const;

 private:
  std::vector<const Transport*> rows_;
};

// Checks that several transports share. "stop" exists, and no command except "release" is empty.
void check_words(const VendorCommands& vendor, const std::string& name, const FileFaults& faults);
void require_port(const NodeConfig& config, const FileFaults& faults, const std::string& example);

}  // namespace trb
