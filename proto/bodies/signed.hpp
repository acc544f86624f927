// Records that prove who made them, also long after the link on which they came is gone.
#pragma once

#include "proto/field.hpp"

namespace trb {

// Purposes: part of what is signed, so that one kind never passes for another.
constexpr std::string_view kSignedCertificate = "certificate";
constexpr std::string_view kSignedRequest = "certificate_request";
constexpr std::string_view kSignedBeacon = "beacon";
constexpr std::string_view kSignedRunStart = "run_start";
constexpr std::string_view kSignedRunAbort = "run_abort";
constexpr std::string_view kSignedResult = "result";

/// Ed25519 over "talkrobots" 0 purpose 0 fleet payload; the fleet is 16 bytes (none in a certificate request).
struct SignedRecord {
  static constexpr std::string_view kSubtype = "signed_record";
  std::string kind;    ///< the purpose
  std::string signer;  ///< id of the node; "" for the fleet authority
  Blob payload;        ///< the msgpack body of that purpose
  Blob signature;      ///< 64 bytes
  bool operator==(const SignedRecord&) const = default;
  static constexpr auto fields() {
    return std::tuple{field("kind", &SignedRecord::kind, 32), field("signer", &SignedRecord::signer, 64),
                      field("payload", &SignedRecord::payload, 1U << 19U),
                      field("signature", &SignedRecord::signature, 64)};
  }
};

enum class Role : std::uint8_t { robot = 0, cloud = 1 };
constexpr auto enum_names(Role) {
  return std::array<std::string_view, 2>{"robot", "cloud"};
}

/// What the fleet authority says of a node. Signed with purpose "certificate".
struct Certificate {
  static constexpr std::string_view kSubtype = "certificate";
  Blob fleet;  ///< 16 bytes, from the authority's key
  std::uint64_t serial = 0;
  std::string id;
  Role role{};
  Blob identity_key;            ///< Ed25519 public key, 32 bytes
  Blob link_key;                ///< CURVE public key, 32 bytes
  std::int64_t not_before = 0;  ///< UTC ns
  std::int64_t not_after = 0;   ///< UTC ns
  bool operator==(const Certificate&) const = default;
  static constexpr auto fields() {
    return std::tuple{field("fleet", &Certificate::fleet, 16),
                      field("serial", &Certificate::serial),
                      field("id", &Certificate::id, 64),
                      field("role", &Certificate::role),
                      field("identity_key", &Certificate::identity_key, 32),
                      field("link_key", &Certificate::link_key, 32),
                      field("not_before", &Certificate::not_before),
                      field("not_after", &Certificate::not_after)};
  }
};

/// What `trb fleet request` writes: the node's public keys, signed by its own identity key (proof of possession).
struct CertificateRequest {
  static constexpr std::string_view kSubtype = "certificate_request";
  std::string id;
  Role role{};
  Blob identity_key;
  Blob link_key;
  static constexpr auto fields() {
    return std::tuple{field("id", &CertificateRequest::id, 64), field("role", &CertificateRequest::role),
                      field("identity_key", &CertificateRequest::identity_key, 32),
                      field("link_key", &CertificateRequest::link_key, 32)};
  }
};

/// The content of a beacon, signed by the node (purpose "beacon"), then encrypted with the fleet's beacon key.
struct Beacon {
  static constexpr std::string_view kSubtype = "beacon";
  SignedRecord certificate;
  std::string address;  ///< HOST:PORT of the inbox; the datagram's own sender address is not believed
  std::uint64_t boot = 0;
  std::int64_t sent = 0;    ///< UTC ns
  std::uint64_t count = 0;  ///< rises within a boot: an older one is a replay
  static constexpr auto fields() {
    return std::tuple{field("certificate", &Beacon::certificate), field("address", &Beacon::address, 80),
                      field("boot", &Beacon::boot), field("sent", &Beacon::sent), field("count", &Beacon::count)};
  }
};

}  // namespace trb
