#pragma once

#include <string>

namespace trb::cli {

struct HostPort {
  std::string host;  ///< IPv4, or IPv6 without its brackets
  std::string port;
};

/// Splits "10.0.0.1:45000" or "[fd00::1]:45000"; empty host if it is neither.
HostPort split_address(const std::string& address);

}  // namespace trb::cli
