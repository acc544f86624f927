// NODE_DIR/cloud.json: where the cloud's gateway listens, and by which addresses people reach it.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "common/base/config_fault.hpp"
#include "proto/value.hpp"

namespace trb {

/// A PostgreSQL database that several gateways share.
struct DatabaseAddress {
  std::string user;
  std::string host;  ///< a name, an address, or the folder of a socket
  std::uint16_t port = 5432;
  std::string name;

  /// On this machine: no network sees what is said.
  [[nodiscard]] bool is_local() const;
  /// For people: "postgresql://HOST:PORT/NAME".
  [[nodiscard]] std::string text() const;
};

struct CloudSettings {
  std::string address = "127.0.0.1";  ///< a number; 127.0.0.1 is for this machine alone
  std::uint16_t port = 8443;
  /// Host names by which people reach it, of the certificate and the page's address; with a port, if that of a proxy
  /// is another one.
  std::vector<std::string> names;
  /// Numeric addresses of proxies: many people's connections come from one.
  std::vector<std::string> proxies;

  std::uint32_t history_days = 30;  ///< what is older goes
  std::uint32_t history_mb = 256;   ///< what is more goes, the oldest first

  std::optional<DatabaseAddress> database;  ///< nothing: files in the node's own folder

  /// "https://NAME:PORT" for localhost, the address and each name.
  [[nodiscard]] std::vector<std::string> origins() const;
};

/// "listen": "HOST:PORT", "names": ["hall.example", "hall.example:443"], "proxies": ["10.0.0.7"],
/// "history": {"days": 30, "megabytes": 256},
/// "database": "postgresql://USER@HOST:PORT/NAME" or "postgresql://USER@/NAME?host=/FOLDER/OF/ITS/SOCKET".
CloudSettings read_cloud(const Value& json, const std::string& file, ConfigFaults& faults);
/// NODE_DIR/cloud.json; the file is optional.
CloudSettings read_cloud_file(const std::string& node_dir, ConfigFaults& faults);

}  // namespace trb
