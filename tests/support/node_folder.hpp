// A node's folder for tests: valid files in a temporary place, each of which a test may replace.
#pragma once

#include <string>

#include "common/base/test/temporary_folder.hpp"
#include "common/config/node_config.hpp"
#include "common/drivers/registry.hpp"

namespace trb {

class NodeFolder {
 public:
  /// The files of a robot's node: framework "lines" (interpreter) or "ur" (direct), or "cloud" for the cloud's.
  explicit NodeFolder(const std::string& framework = "lines");

  void write(const std::string& name, const std::string& text) const;
  void remove(const std::string& name) const;
  /// Replaces the first occurrence of a text in a file; fails if there is none.
  void change(const std::string& name, const std::string& from, const std::string& to) const;
  /// Makes keys and has them signed by a new authority.
  void sign(const std::string& id, Role role) const;

  [[nodiscard]] NodeCheck check(bool running = true) const {
    return check_node_dir(folder_.path, running, drivers::robot_transports());
  }
  [[nodiscard]] const std::string& path() const { return folder_.path; }

 private:
  TemporaryFolder folder_;
};

/// The faults, without those of the keys.
ConfigFaults without_keys(const ConfigFaults& faults);

}  // namespace trb
