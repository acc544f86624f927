#include "common/security/invitation.hpp"

#include <sodium.h>

#include "common/security/raw.hpp"
#include "proto/body.hpp"

namespace trb {
namespace {

Status check_form(const Invitation& invitation, const FleetAuthority& authority) {
  if (!same_bytes(invitation.fleet.bytes, authority.id()))
    return fail(Errc::foreign_fleet, "the invitation is another fleet's", "invite with this fleet's folder");
  if (invitation.caller.bytes.size() != crypto_box_PUBLICKEYBYTES)
    return fail(Errc::malformed, "invitation: caller: no key of 32 bytes");
  return Done{};
}

}  // namespace

InvitationKeys invitation_keys(BytesView secret) {
  InvitationKeys keys;
  keys.caller = {Bytes(crypto_box_PUBLICKEYBYTES, '\0'), Bytes(crypto_box_SECRETKEYBYTES, '\0')};
  Bytes seed = purpose_digest("invitation caller", secret);
  crypto_box_seed_keypair(raw(keys.caller.public_key), raw(keys.caller.secret_key), raw(seed));
  sodium_memzero(seed.data(), seed.size());
  keys.to_node = purpose_digest("invitation to node", secret);
  keys.to_inviter = purpose_digest("invitation to inviter", secret);
  return keys;
}

Bytes lock_join(BytesView key, BytesView plain) {
  Bytes out = random_bytes(crypto_secretbox_NONCEBYTES);
  out.resize(crypto_secretbox_NONCEBYTES + crypto_secretbox_MACBYTES + plain.size());
  crypto_secretbox_easy(raw(out) + crypto_secretbox_NONCEBYTES, raw(plain), plain.size(), raw(out), raw(key));
  return out;
}

Result<Bytes> unlock_join(BytesView key, BytesView box) {
  constexpr std::size_t kHead = crypto_secretbox_NONCEBYTES + crypto_secretbox_MACBYTES;
  if (box.size() < kHead) return fail(Errc::wrong_key, "box: shorter than an empty one");
  Bytes plain(box.size() - kHead, '\0');
  const BytesView sealed = box.substr(crypto_secretbox_NONCEBYTES);
  if (crypto_secretbox_open_easy(raw(plain), raw(sealed), sealed.size(), raw(box), raw(key)) != 0)
    return fail(Errc::wrong_key, "box: made with another code, or changed on its way");
  return plain;
}

SignedRecord sign_invitation(const Invitation& invitation, const SigningKey& authority) {
  return sign(kSignedInvitation, "", invitation.fleet.bytes, encode(invitation), authority);
}

Result<Invitation> open_invitation(const SignedRecord& record, const FleetAuthority& authority, UtcTime now) {
  auto invitation = decode<Invitation>(record.payload.bytes);
  if (!invitation) return invitation;
  if (Status good = check_form(*invitation, authority); !good) return good.error();
  if (!verify(record, kSignedInvitation, authority.id(), authority.public_key))
    return fail(Errc::bad_signature, "the authority has not signed this invitation");
  if (now.ns >= invitation->expires)
    return fail(Errc::expired,
                "the invitation of '" + invitation->name + "' ended " + to_iso8601({invitation->expires}),
                "invite again; if that was a moment ago, one of the two clocks is wrong");
  if (invitation->expires > (now + kInvitationAhead).ns)
    return fail(Errc::bad_value, "the invitation of '" + invitation->name + "' ends more than an hour ahead",
                "set the clock of the computer with the authority's key, or of this node");
  return invitation;
}

Bytes digest_of_request(const SignedRecord& request) {
  return purpose_digest("join request", request.payload.bytes + request.signature.bytes);
}

void dial_at(std::vector<FleetSeed>& seeds, const FleetSeed& door) {
  std::erase_if(seeds, [&](const FleetSeed& seed) { return seed.key == door.key; });
  if (seeds.size() >= kMaxFleetSeeds) seeds.pop_back();
  seeds.insert(seeds.begin(), door);
}

bool same_bytes(BytesView one, BytesView other) {
  return one.size() == other.size() && sodium_memcmp(one.data(), other.data(), one.size()) == 0;
}

}  // namespace trb
