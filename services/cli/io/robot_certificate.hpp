// What certificate a robot shows, and whether it is taken: a handshake of TLS, and nothing more.
#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "common/base/result.hpp"
#include "common/tls/tls_client.hpp"

namespace trb::cli {

struct ShownCertificate {
  PeerCertificate certificate;
  std::optional<Error> refused;  ///< why it is not taken
};

/// Within 5 s. Errors: bad_value (no address), io_error, timeout, malformed (no TLS there).
Result<ShownCertificate> look_at_certificate(const std::string& host, std::uint16_t port, const TlsTrust& trust);

}  // namespace trb::cli
