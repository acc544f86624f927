// A node's folder for tests: valid files in a temporary place, each of which a test may replace.
#pragma once

#include <string>

#include "common/config/node_config.hpp"
#include "common/drivers/registry.hpp"

namespace trb {

class NodeFolder {
 public:
  /// The files of a robot's node: framework "lines" (interpreter) or "ur" (direct), or "cloud" for the cloud's.
  explicit NodeFolder(const std::string& framework = "lines");
  NodeFolder(const NodeFolder&) = delete;
  NodeFolder& operator=(const NodeFolder&) = delete;
  ~NodeFolder();

  void write(const std::string& name, const std::string& text) const;
  void remove(const std::string& name) const;
  /// Replaces the first occurrence of a text in a file; fails if there is none.
  void change(const std::string& name, const std::string& from, const std::string& to) const;
  /// Makes keys and has them signed by a new authority.
  void sign(const std::string& id, Role role) const;

  [[nodiscard]] NodeCheck check(bool running = true) const {
    return check_node_dir(path_, running, drivers::robot_transports());
  }
  [[nodiscard]] const std::string& path() const { return path_; }

 private:
  std::string path_;
};

/// The faults, without those of the keys.
ConfigFaults without_keys(const ConfigFaults& faults);

}  // namespace trb
