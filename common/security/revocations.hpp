// The fleet's revocation list: opening it, and looking a certificate up in it. See proto/bodies/signed.hpp.
#pragma once

#include "common/security/beacon_key.hpp"
#include "common/security/keys.hpp"
#include "proto/bodies/link.hpp"

namespace trb {

/// Opens a list: of this fleet and signed by its authority. Errors: malformed, foreign_fleet, bad_signature.
Result<RevocationList> open_revocations(const SignedRecord& record, const FleetAuthority& authority);

/// The entry that revokes this certificate, or nullptr. An entry covers every certificate of its id up to its serial:
/// an older, forgotten certificate of the same node must be of no use to a thief.
const Revocation* find_revocation(const RevocationList& list, const Certificate& certificate);

/// Does `row` say at least what `entry` says? The keys of an entry that names them are named by no other's.
bool covers(const Revocation& row, const Revocation& entry);
/// Those of `entries` that no row of the list covers.
std::vector<Revocation> not_in_list(const RevocationList& list, const std::vector<Revocation>& entries);
/// Those of `entries` some of whose certificates the list does not revoke, whatever it says of their keys.
std::vector<Revocation> not_revoked_by(const RevocationList& list, const std::vector<Revocation>& entries);

/// The beacon key that the list brings to this node. Errors: missing (no box for it), wrong_key.
Result<BeaconKey> open_listed_beacon_key(const RevocationList& list, std::string_view id, const LinkKey& link);

/// A revocation list or renewed certificates, as files and programs pass them on: FLEET_DIR/news.json,
/// NODE_DIR/keys/news.json. Errors: missing, malformed, too_large; each names the path.
Result<TrustUpdate> read_trust_updates(const std::string& path);
Status write_trust_updates(const std::string& path, const TrustUpdate& update);

}  // namespace trb
