// The certificate with which the gateway is reached: the operator's own, or one that is made at the first start.
#pragma once

#include <string>
#include <vector>

#include "common/base/result.hpp"
#include "common/base/time.hpp"

namespace trb::gateway {

struct TlsFiles {
  std::string certificate;  ///< PEM
  std::string key;          ///< PEM, 0600
};

/// NODE_DIR/keys/gateway.crt and gateway.key. If both are missing they are made: EC P-256, self-signed, for these names
/// and addresses, 825 days. Errors: io_error; missing (one of the two).
Result<TlsFiles> provide_tls_files(const std::string& node_dir, const std::vector<std::string>& names, UtcTime now);

/// SHA-256 of the certificate (DER), "AB:CD:...": what a browser shows, for people to compare. Errors: io_error,
/// malformed.
Result<std::string> fingerprint(const std::string& certificate_file);

}  // namespace trb::gateway
