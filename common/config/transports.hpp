// What the transports ask of commands.json. Each is told by its driver (common/drivers); a service that speaks to no
// robot knows none, and takes the file as it is.
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
  Mode mode{};  ///< the first transport of a mode is the one that is meant where commands.json names none
  /// That the words of the node's own vendor can be read, and its skills have words and ends that are seen.
  void (*check)(const NodeConfig&, const FileFaults&) = nullptr;
  /// Reads the keys that no other transport has; may be null.
  void (*read)(ObjectReader& vendor, VendorCommands& into) = nullptr;
  std::vector<std::string_view> monitors{};     ///< protocols of a monitor connection
  std::vector<std::string_view> languages{};    ///< how its commands may be written, beside "plain"
  std::vector<std::string_view> wraps{};        ///< what its commands may be put into
  std::vector<std::string> monitored_values{};  ///< that the monitor tells without being asked
  bool names_values = true;                     ///< false: the robot names what it tells as it goes
};

class Transports {
 public:
  Transports() = default;
  explicit Transports(std::vector<const Transport*> rows) : rows_(std::move(rows)) {}

  [[nodiscard]] bool empty() const { return rows_.empty(); }
  [[nodiscard]] const Transport* find(std::string_view name) const;
  /// What a vendor without "transport" means in that mode; empty if there is none.
  [[nodiscard]] std::string default_of(Mode mode) const;
  [[nodiscard]] std::vector<std::string> names() const;
  [[nodiscard]] std::string names_of(Mode mode) const;  ///< "tcp-text, modbus"
  /// "plain" or "", and what the transports add to it.
  [[nodiscard]] std::vector<std::string> all_of(std::vector<std::string_view> Transport::*list,
                                                std::vector<std::string> first) const;
  /// That the node's own vendor has what its transport needs, and that the transport is of the node's mode.
  void check(const NodeConfig& config, const FileFaults& faults) const;

 private:
  std::vector<const Transport*> rows_;
};

// Parts that several of them need.
/// "stop" is there, and no command but "release" is empty.
void check_words(const VendorCommands& vendor, const std::string& name, const FileFaults& faults);
void require_port(const NodeConfig& config, const FileFaults& faults, const std::string& example);

}  // namespace trb
