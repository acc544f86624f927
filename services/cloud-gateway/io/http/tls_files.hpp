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
  UtcTime ends{};           ///< when the certificate does
};

/// So long before its end a certificate of our own is made anew at a start, and people are warned of any other.
constexpr Duration kRenewBefore = std::chrono::hours(24 * 30);

/// NODE_DIR/keys/gateway.crt and gateway.key. If both are missing they are made: EC P-256, self-signed, for these names
/// and addresses, 825 days; one that this has made and that ends within 30 days is made anew. Errors: io_error;
/// missing (one of the two); malformed; wrong_key (of another certificate).
Result<TlsFiles> provide_tls_files(const std::string& node_dir, const std::vector<std::string>& names, UtcTime now);

/// SHA-256 of the certificate (DER), "AB:CD:...": what a browser shows, for people to compare. Errors: io_error,
/// malformed.
Result<std::string> fingerprint(const std::string& certificate_file);

}  // namespace trb::gateway
