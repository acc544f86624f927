// What the two sides of an invitation share: the keys that the code's secret gives, the boxes that they lock, and what
// the authority signs. The cloud node between them has none of these keys.
#pragma once

#include "common/security/keys.hpp"
#include "proto/bodies/invitation.hpp"

namespace trb {

constexpr Duration kInvitationTime = std::chrono::minutes(10);
/// How far ahead an invitation may expire by the clock of a node that reads it: the clocks may differ.
constexpr Duration kInvitationAhead = std::chrono::minutes(60);

/// Each for one purpose: who has one of them knows nothing of the others, nor of the secret.
struct InvitationKeys {
  LinkKey caller;    ///< of the new node's connection to the cloud node
  Bytes to_node;     ///< locks what the inviter writes, 32 bytes
  Bytes to_inviter;  ///< locks what the new node writes, 32 bytes
};

InvitationKeys invitation_keys(BytesView secret);

/// A random nonce, then the XSalsa20-Poly1305 box.
Bytes lock_join(BytesView key, BytesView plain);
/// Errors: wrong_key: made with another key, or changed.
Result<Bytes> unlock_join(BytesView key, BytesView box);

SignedRecord sign_invitation(const Invitation& invitation, const SigningKey& authority);

/// Errors: malformed, foreign_fleet, bad_signature, expired, bad_value (it expires too late).
Result<Invitation> open_invitation(const SignedRecord& record, const FleetAuthority& authority, UtcTime now);

/// What an offer names a request by.
Bytes digest_of_request(const SignedRecord& request);

/// The cloud node with that key is dialled at that address, whatever the list said of it.
void dial_at(std::vector<FleetSeed>& seeds, const FleetSeed& door);

/// Do these bytes agree? The time that it takes does not tell where they differ.
bool same_bytes(BytesView one, BytesView other);

}  // namespace trb
