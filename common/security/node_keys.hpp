// The keys of a node's folder: keys/identity.key, keys/link.key (0600), keys/certificate.json.
#pragma once

#include <string>

#include "common/base/config_fault.hpp"
#include "common/security/beacon_key.hpp"
#include "common/security/keys.hpp"
#include "proto/bodies/invitation.hpp"

namespace trb {

struct NodeKeys {
  SigningKey identity;
  LinkKey link;
  SignedRecord certificate_record;
  Certificate certificate;
  FleetAuthority authority;
  BeaconKey beacon;
  SignedRecord revocations;  ///< the list that came with the certificate; an empty kind for none
};

/// What a service knows of its node, without a secret.
struct NodeCertificate {
  SignedRecord record;
  Certificate certificate;
  FleetAuthority authority;
  std::vector<FleetSeed> seeds;  ///< cloud nodes that came with the certificate
};

/// Makes identity and link key in NODE_DIR/keys, if missing, and writes keys/request.json for `trb fleet sign`. Errors:
/// bad_value (id), io_error.
Status make_request(const std::string& node_dir, const std::string& id, Role role);

/// A secret X25519 key as hexadecimal text, with its public half. Errors: missing, not_permitted (mode is not 0600),
/// malformed.
Result<LinkKey> read_link_key(const std::string& path);

/// Reads keys/certificate.json alone. Errors: missing, malformed, and those of open_certificate_any_time.
Result<NodeCertificate> load_node_certificate(const std::string& node_dir);

/// Reads the keys. Errors: missing, not_permitted (mode is not 0600), malformed, wrong_key (the certificate is for
/// other keys), and those of open_certificate_any_time.
Result<NodeKeys> load_node_keys(const std::string& node_dir);

/// The same as faults for `trb check`; also an id that differs from node.json's, and an expired certificate. `apart`:
/// for a service in a container of its own, which has the certificate and no secret of its node.
void check_node_keys(const std::string& node_dir, const std::string& id, UtcTime now, ConfigFaults& faults,
                     bool apart = false);

}  // namespace trb
