// The fleet authority's folder (`trb fleet init`): the signing key, encrypted with a passphrase, and the beacon key. It
// is on no node.
#pragma once

#include <string>

#include "common/security/certificate_file.hpp"

namespace trb {

struct Authority {
  FleetAuthority fleet;
  SigningKey key;
  BeaconKey beacon;
  std::uint64_t next_serial = 1;
};

constexpr std::size_t kMinPassphrase = 12;

/// Makes fleet.json (public) and authority.key (0600, argon2id + XSalsa20-Poly1305). Errors: conflict if there is one
/// already, bad_value (passphrase under kMinPassphrase characters), io_error.
Result<Authority> make_authority(const std::string& dir, const std::string& name, const std::string& passphrase);

/// Errors: missing, malformed, not_permitted (file mode, or the passphrase is wrong).
Result<Authority> open_authority(const std::string& dir, const std::string& passphrase);

/// The public half, no passphrase needed.
Result<FleetAuthority> read_fleet(const std::string& dir);

/// Checks a request's proof of possession and signs a certificate; takes and stores the next serial number.
/// Errors: malformed, bad_signature, bad_value, io_error.
Result<CertificateFile> sign_request(Authority& authority, const std::string& dir, const SignedRecord& request,
                                     UtcTime now, Duration validity);

}  // namespace trb
