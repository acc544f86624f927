// Certificates as PEM, made and looked at with OpenSSL. No files.
#pragma once

#include <string>
#include <vector>

#include "common/base/bytes.hpp"
#include "common/base/result.hpp"
#include "common/base/time.hpp"

namespace trb::gateway {

struct PemPair {
  std::string certificate;
  std::string key;  ///< PKCS 8, not encrypted
};

/// Days: the most that browsers take of a certificate that no public authority has signed.
constexpr int kCertificateDays = 825;

/// EC P-256, signed by itself, for a server and not for an authority (RFC 5280, 4.2.1). `names`: host names and numeric
/// addresses, one at least. Valid from an hour before `now`, as clocks differ. Errors: bad_value (a name), io_error
/// (OpenSSL).
Result<PemPair> make_self_signed(const std::vector<std::string>& names, UtcTime now);

struct CertificateFacts {
  UtcTime ends;
  bool is_own = false;  ///< made by make_self_signed()
};
/// Of the first certificate. Errors: malformed.
Result<CertificateFacts> facts_of(BytesView certificate);

/// False too for what is no PEM.
bool is_key_of(BytesView certificate, BytesView key);
/// Is it one in PEM, without a passphrase?
bool is_private_key(BytesView key);
/// Under 112 bits of security, as RSA with 1024: OpenSSL serves with none. False too for what is no key.
bool is_weak_key(BytesView key);

/// SHA-256 of the first certificate (DER), "AB:CD:...". Errors: malformed.
Result<std::string> fingerprint_of(BytesView certificate);

}  // namespace trb::gateway
