// NODE_DIR/cloud.json: where the cloud's gateway listens, and by which addresses people reach it.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "common/base/config_fault.hpp"
#include "proto/value.hpp"

namespace trb {

struct CloudSettings {
  std::string address = "127.0.0.1";  ///< a number; 127.0.0.1 is for this machine alone
  std::uint16_t port = 8443;
  std::vector<std::string> names;  ///< host names by which people reach it: of the certificate and the page's address

  std::uint32_t history_days = 30;  ///< what is older goes
  std::uint32_t history_mb = 256;   ///< what is more goes, the oldest first

  /// "https://NAME:PORT" for localhost, the address and each name.
  [[nodiscard]] std::vector<std::string> origins() const;
};

/// "listen": "HOST:PORT", "names": ["hall.example"], "history": {"days": 30, "megabytes": 256}.
CloudSettings read_cloud(const Value& json, const std::string& file, ConfigFaults& faults);
/// NODE_DIR/cloud.json; the file is optional.
CloudSettings read_cloud_file(const std::string& node_dir, ConfigFaults& faults);

}  // namespace trb
