#include "common/security/revocations.hpp"

#include <algorithm>

#include "common/base/files.hpp"
#include "proto/body.hpp"

namespace trb {

Result<RevocationList> open_revocations(const SignedRecord& record, const FleetAuthority& authority) {
  auto list = decode<RevocationList>(record.payload.bytes);
  if (!list) return list;
  if (list->fleet.bytes != authority.id()) {
    return fail(Errc::foreign_fleet, "revocation list of another fleet", "bring the news of this fleet's authority");
  }
  // The signer's name is not signed: a record with one would be a second form of the same list.
  if (!record.signer.empty() || !verify(record, kSignedRevocations, authority.id(), authority.public_key)) {
    return fail(Errc::bad_signature, "revocation list was not signed by this fleet's authority",
                "bring news.json again from the authority's folder");
  }
  return list;
}

const Revocation* find_revocation(const RevocationList& list, const Certificate& certificate) {
  const auto at = std::find_if(list.revoked.begin(), list.revoked.end(), [&](const Revocation& entry) {
    return entry.id == certificate.id && entry.serial >= certificate.serial;
  });
  return at == list.revoked.end() ? nullptr : &*at;
}

Result<BeaconKey> open_listed_beacon_key(const RevocationList& list, std::string_view id, const LinkKey& link) {
  for (const SealedKey& sealed : list.beacon_keys) {
    if (sealed.id == id) return open_sealed_beacon_key(list.beacon_number, sealed.box.bytes, link);
  }
  return fail(Errc::missing, "revocation list " + std::to_string(list.number) + " has no beacon key for this node",
              "have it signed again: trb fleet sign");
}

Result<TrustUpdate> read_trust_updates(const std::string& path) {
  auto text = read_file(path);
  if (!text) return text.error();
  auto update = from_json<TrustUpdate>(*text);
  if (!update)
    return fail(update.error().code, path + ": " + update.error().what, "copy it again from the authority's folder");
  return update;
}

Status write_trust_updates(const std::string& path, const TrustUpdate& update) {
  // For anybody to read: it holds no secret, and is carried to a node as another user than the node's.
  return write_file(path, to_json(update) + "\n", 0644);
}

}  // namespace trb
