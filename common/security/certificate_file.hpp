// keys/certificate.json: what `trb fleet sign` gives back to a node. Its secret is readable only with the node's link
// key, so the file may be copied over any medium.
#pragma once

#include <string>

#include "common/security/beacon_key.hpp"
#include "common/security/keys.hpp"
#include "proto/bodies/invitation.hpp"

namespace trb {

struct CertificateFile {
  SignedRecord certificate;
  FleetAuthority authority;
  std::uint32_t beacon_number = 0;
  Bytes sealed_beacon;             ///< the beacon key in a sealed box for the node's link key
  SignedRecord revocations;        ///< the fleet's list at the time of signing; an empty kind for none
  std::vector<FleetSeed> seeds{};  ///< cloud nodes; of a node that has joined by a code
};

CertificateFile make_certificate_file(const SignedRecord& certificate, const FleetAuthority& authority,
                                      const BeaconKey& beacon, BytesView link_key);
std::string certificate_file_to_json(const CertificateFile& file);

/// Errors: missing, malformed; each names the key.
Result<CertificateFile> certificate_file_from_json(std::string_view text);

/// The same for a file; each error names the path.
Result<CertificateFile> read_certificate_file(const std::string& path);

/// Errors: wrong_key if the box was made for another link key.
Result<BeaconKey> open_beacon_key(const CertificateFile& file, const LinkKey& link);

}  // namespace trb
