// Keys, signatures, certificates: libsodium behind named functions.
#pragma once

#include <string>
#include <string_view>

#include "common/base/bytes.hpp"
#include "common/base/result.hpp"
#include "common/base/time.hpp"
#include "proto/bodies/signed.hpp"

namespace trb {

/// Must be called once before anything else here; throws std::runtime_error if libsodium cannot start.
void init_crypto();

/// 32 bytes public, 64 bytes secret (Ed25519).
struct SigningKey {
  Bytes public_key;
  Bytes secret_key;
};

/// 32 bytes each (X25519, as CURVE uses them).
struct LinkKey {
  Bytes public_key;
  Bytes secret_key;
};

SigningKey make_signing_key();
LinkKey make_link_key();
Bytes random_bytes(std::size_t count);
std::uint64_t random_u64();

/// BLAKE2b-256.
Bytes digest(BytesView bytes);

/// BLAKE2b-256 for one purpose: a session id never has the same hash as a token or an audit record.
Bytes purpose_digest(std::string_view purpose, BytesView bytes);

/// The fleet's id: the first 16 bytes of the digest of the authority's public key.
Bytes fleet_id(BytesView authority_key);

/// Signs payload for a purpose (one of kSigned…) within a fleet (16-byte id).
SignedRecord sign(std::string_view purpose, std::string_view signer, BytesView fleet, Bytes payload,
                  const SigningKey& key);

/// True if the record has that purpose and fleet and was made with that key pair.
bool verify(const SignedRecord& record, std::string_view purpose, BytesView fleet, BytesView public_key);

/// The public half of the fleet: what every node knows about its authority.
struct FleetAuthority {
  std::string name;
  Bytes public_key;  ///< Ed25519
  [[nodiscard]] Bytes id() const { return fleet_id(public_key); }
};

/// Opens a certificate: signed by the authority, well-formed, valid now. Errors: malformed, foreign_fleet (made for
/// another authority), bad_signature, cert_not_yet_valid, cert_expired.
Result<Certificate> open_certificate(const SignedRecord& record, const FleetAuthority& authority, UtcTime now);

/// Errors: cert_not_yet_valid, cert_expired.
Status check_dates(const Certificate& certificate, UtcTime now);

/// The same without checking the dates.
Result<Certificate> open_certificate_any_time(const SignedRecord& record, const FleetAuthority& authority);

/// Has the node got other keys since? A renewed certificate is of the same keys. Serials of one authority only rise.
bool has_newer_keys(const Certificate& now, const Certificate& before);

/// Has this member signed the record? Errors: source_mismatch, not_permitted, bad_signature.
Status check_record(const SignedRecord& record, std::string_view purpose, const Certificate& signer);

/// Opens a signed record of a member: its certificate's id must be record.signer. Errors: bad_signature, malformed.
template <class T>
Result<T> open_record(const SignedRecord& record, std::string_view purpose, const Certificate& signer);

}  // namespace trb
