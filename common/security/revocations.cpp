#include "common/security/revocations.hpp"

#include <algorithm>
#include <map>

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

bool covers(const Revocation& row, const Revocation& entry) {
  if (row.id != entry.id || row.serial < entry.serial) return false;
  return entry.identity.bytes.empty() || (row.identity == entry.identity && row.link == entry.link);
}

std::vector<Revocation> not_in_list(const RevocationList& list, const std::vector<Revocation>& entries) {
  std::multimap<std::string_view, const Revocation*> rows;
  for (const Revocation& row : list.revoked) rows.emplace(row.id, &row);
  std::vector<Revocation> out;
  for (const Revocation& entry : entries) {
    const auto [first, last] = rows.equal_range(entry.id);
    if (std::none_of(first, last, [&](const auto& row) { return covers(*row.second, entry); })) out.push_back(entry);
  }
  return out;
}

std::vector<Revocation> not_revoked_by(const RevocationList& list, const std::vector<Revocation>& entries) {
  std::map<std::string_view, std::uint64_t> up_to;
  for (const Revocation& row : list.revoked) up_to[row.id] = std::max(up_to[row.id], row.serial);
  std::vector<Revocation> out;
  for (const Revocation& entry : entries) {
    const auto at = up_to.find(entry.id);
    if (at == up_to.end() || at->second < entry.serial) out.push_back(entry);
  }
  return out;
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
