// Records that prove who made them, even long after the link on which they came is closed.
#pragma once

#include "proto/field.hpp"
#include "proto/travel.hpp"

namespace trb {

// Purposes: part of what is signed, so that a record of one kind never passes for another.
constexpr std::string_view kSignedCertificate = "certificate";
constexpr std::string_view kSignedRequest = "certificate_request";
constexpr std::string_view kSignedBeacon = "beacon";
constexpr std::string_view kSignedRunStart = "run_start";
constexpr std::string_view kSignedRunAbort = "run_abort";
constexpr std::string_view kSignedRunPause = "run_pause";
constexpr std::string_view kSignedRunEnd = "run_end";
constexpr std::string_view kSignedResult = "result";
constexpr std::string_view kSignedChoice = "choice";
constexpr std::string_view kSignedDecision = "decision";
constexpr std::string_view kSignedAuditHead = "audit_head";
constexpr std::string_view kSignedRevocations = "revocation_list";
constexpr std::string_view kSignedSeal = "seal";
constexpr std::string_view kSignedRelayed = "relayed";
constexpr std::string_view kSignedInvitation = "invitation";

/// Ed25519 over "talkrobots" 0 purpose 0 fleet payload; the fleet is 16 bytes (none in a certificate request).
struct SignedRecord {
  static constexpr std::string_view kSubtype = "signed_record";
  static constexpr Travel kTravel = on_bus(CostPhase::upkeep);
  std::string kind;    ///< the purpose
  std::string signer;  ///< id of the node; "" for the fleet authority
  Blob payload;        ///< the msgpack body of that purpose
  Blob signature;      ///< 64 bytes
  bool operator==(const SignedRecord&) const = default;
  template <class T = SignedRecord>
  static FieldTable fields() {
    return FieldTable{field("kind", &T::kind, 32), field("signer", &T::signer, 64),
                      field("payload", &T::payload, 1U << 19U), field("signature", &T::signature, 64)};
  }
};

enum class Role : std::uint8_t { robot = 0, cloud = 1 };
constexpr auto enum_names(Role) {
  return std::array<std::string_view, 2>{"robot", "cloud"};
}

/// What the fleet authority certifies about a node. Signed with purpose "certificate".
struct Certificate {
  static constexpr std::string_view kSubtype = "certificate";
  static constexpr Travel kTravel = in_record();
  Blob fleet;  ///< 16 bytes, from the authority's key
  std::uint64_t serial = 0;
  std::string id;
  Role role{};
  Blob identity_key;            ///< Ed25519 public key, 32 bytes
  Blob link_key;                ///< CURVE public key, 32 bytes
  std::int64_t not_before = 0;  ///< UTC ns
  std::int64_t not_after = 0;   ///< UTC ns
  bool relay = false;           ///< may carry messages between members that cannot reach each other
  bool operator==(const Certificate&) const = default;
  template <class T = Certificate>
  static FieldTable fields() {
    return FieldTable{field("fleet", &T::fleet, 16),
                      field("serial", &T::serial),
                      field("id", &T::id, 64),
                      field("role", &T::role),
                      field("identity_key", &T::identity_key, 32),
                      field("link_key", &T::link_key, 32),
                      field("not_before", &T::not_before),
                      field("not_after", &T::not_after),
                      field("relay", &T::relay)};
  }
};

/// What `trb fleet request` writes: the node's public keys, signed by its own identity key (proof of possession).
struct CertificateRequest {
  static constexpr std::string_view kSubtype = "certificate_request";
  static constexpr Travel kTravel = in_record();
  std::string id;
  Role role{};
  Blob identity_key;
  Blob link_key;
  template <class T = CertificateRequest>
  static FieldTable fields() {
    return FieldTable{field("id", &T::id, 64), field("role", &T::role), field("identity_key", &T::identity_key, 32),
                      field("link_key", &T::link_key, 32)};
  }
};

/// The content of a beacon, signed by the node (purpose "beacon"), then encrypted with the fleet's beacon key.
struct Beacon {
  static constexpr std::string_view kSubtype = "beacon";
  static constexpr Travel kTravel = in_record(CostPhase::identification);
  SignedRecord certificate;
  std::string address;  ///< HOST:PORT of the inbox; the datagram's own sender address is not trusted
  std::uint64_t boot = 0;
  std::int64_t sent = 0;    ///< UTC ns
  std::uint64_t count = 0;  ///< rises within a boot: a lower one is a replay
  template <class T = Beacon>
  static FieldTable fields() {
    return FieldTable{field("certificate", &T::certificate), field("address", &T::address, 80), field("boot", &T::boot),
                      field("sent", &T::sent), field("count", &T::count)};
  }
};

constexpr std::size_t kRevokedKey = 16;  ///< bytes of a key: enough to know it again

/// Certificates that must no longer be accepted: those of this id up to this serial. The rest says to an authority's
/// folder that never had them what it must know: how long the entry is needed, and which keys it never certifies again.
struct Revocation {
  std::uint64_t serial = 0;
  std::string id;
  std::string reason;
  std::int64_t at = 0;     ///< UTC ns
  std::int64_t until = 0;  ///< UTC ns: when the last of them ends; 0: not known
  Blob identity{};         ///< the first kRevokedKey bytes of its identity key; empty: not known
  Blob link{};             ///< and of its link key
  bool operator==(const Revocation&) const = default;
  template <class T = Revocation>
  static FieldTable fields() {
    return FieldTable{field("serial", &T::serial),         field("id", &T::id, 64),
                      field("reason", &T::reason, 128),    field("at", &T::at),
                      field("until", &T::until),           field("identity", &T::identity, kRevokedKey),
                      field("link", &T::link, kRevokedKey)};
  }
};

/// The fleet's beacon key in a sealed box (X25519, 80 bytes) that only one node's link key opens.
struct SealedKey {
  std::string id;
  Blob box;
  bool operator==(const SealedKey&) const = default;
  template <class T = SealedKey>
  static FieldTable fields() {
    return FieldTable{field("id", &T::id, 64), field("box", &T::box, 80)};
  }
};

/// What the authority has revoked, numbered from 1: only the newest list counts. Each revocation brings a new beacon
/// key, sealed for every node that stays. Signed with purpose "revocation_list".
struct RevocationList {
  static constexpr std::string_view kSubtype = "revocation_list";
  static constexpr Travel kTravel = in_record();
  Blob fleet;  ///< 16 bytes
  std::uint64_t number = 0;
  std::int64_t issued = 0;  ///< UTC ns
  std::vector<Revocation> revoked;
  std::uint32_t beacon_number = 0;
  std::vector<SealedKey> beacon_keys;
  bool operator==(const RevocationList&) const = default;
  template <class T = RevocationList>
  static FieldTable fields() {
    return FieldTable{field("fleet", &T::fleet, 16),
                      field("number", &T::number),
                      field("issued", &T::issued),
                      field("revoked", &T::revoked, 2000),
                      field("beacon_number", &T::beacon_number),
                      field("beacon_keys", &T::beacon_keys, 2000)};
  }
};

/// What a seal states: these messages, in this order, were sent in this direction of this link. Signed with purpose
/// "seal" by the sender.
struct SealedRange {
  static constexpr std::string_view kSubtype = "sealed_range";
  static constexpr Travel kTravel = in_record();
  std::uint64_t link = 0;
  std::uint64_t serial = 0;       ///< of the sender's certificate
  std::uint64_t peer_serial = 0;  ///< of the receiver's
  bool dialled = false;           ///< the sender is the side that dialled the link
  std::uint64_t first = 0;        ///< sequences; the seal's own is last + 1, and only its signature covers it
  std::uint64_t last = 0;
  Blob previous;  ///< BLAKE2b-256 of the payload of this direction's previous seal, 32 zeros for the first
  Blob hash;      ///< BLAKE2b-256 of `previous` and, for each frame as sent, its size (u32, big-endian) and its bytes
  std::int64_t utc = 0;
  bool operator==(const SealedRange&) const = default;
  template <class T = SealedRange>
  static FieldTable fields() {
    return FieldTable{field("link", &T::link),
                      field("serial", &T::serial),
                      field("peer_serial", &T::peer_serial),
                      field("dialled", &T::dialled),
                      field("first", &T::first),
                      field("last", &T::last),
                      field("previous", &T::previous, 32),
                      field("hash", &T::hash, 32),
                      field("utc", &T::utc)};
  }
};

/// A message that goes through a third member, because its two ends cannot reach each other. Signed by the source with
/// purpose "relayed".
struct RelayedFrame {
  static constexpr std::string_view kSubtype = "relayed_frame";
  static constexpr Travel kTravel = in_record();
  std::string target;
  std::uint64_t target_boot = 0;  ///< for this start of the target's router only; 0 in a relay_alive: not known
  std::uint64_t source_boot = 0;
  std::uint64_t count = 0;   ///< rises within a boot of the source, for each target: a lower one is a replay
  std::int64_t expires = 0;  ///< UTC ns
  Blob box;                  ///< the message as on any link, with link and sequence 0; only the target can open it
  bool operator==(const RelayedFrame&) const = default;
  template <class T = RelayedFrame>
  static FieldTable fields() {
    return FieldTable{field("target", &T::target, 64),       field("target_boot", &T::target_boot),
                      field("source_boot", &T::source_boot), field("count", &T::count),
                      field("expires", &T::expires),         field("box", &T::box, (1U << 19U) - 1024)};
  }
};

}  // namespace trb
