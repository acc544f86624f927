#include "common/security/keys.hpp"

#include <sodium.h>

#include <stdexcept>

#include "common/security/raw.hpp"
#include "common/security/rights.hpp"
#include "proto/body.hpp"

namespace trb {
namespace {

/// What is really signed: every part is delimited, so that none can be shifted into another.
Bytes signed_bytes(std::string_view purpose, BytesView fleet, BytesView payload) {
  constexpr std::string_view kName = "talkrobots";
  Bytes out;
  out.reserve(kName.size() + 1 + purpose.size() + 1 + fleet.size() + payload.size());
  out += kName;
  out += '\0';
  out += purpose;
  out += '\0';
  out += fleet;
  out += payload;
  return out;
}

}  // namespace

void init_crypto() {
  if (sodium_init() < 0) throw std::runtime_error("libsodium could not be initialised");
}

SigningKey make_signing_key() {
  SigningKey key{Bytes(crypto_sign_PUBLICKEYBYTES, '\0'), Bytes(crypto_sign_SECRETKEYBYTES, '\0')};
  crypto_sign_keypair(raw(key.public_key), raw(key.secret_key));
  return key;
}

LinkKey make_link_key() {
  LinkKey key{Bytes(crypto_box_PUBLICKEYBYTES, '\0'), Bytes(crypto_box_SECRETKEYBYTES, '\0')};
  crypto_box_keypair(raw(key.public_key), raw(key.secret_key));
  return key;
}

Bytes random_bytes(std::size_t count) {
  Bytes out(count, '\0');
  randombytes_buf(out.data(), count);
  return out;
}

std::uint64_t random_u64() {
  std::uint64_t out = 0;
  while (out == 0) randombytes_buf(&out, sizeof out);
  return out;
}

Bytes digest(BytesView bytes) {
  Bytes out(32, '\0');
  crypto_generichash(raw(out), out.size(), raw(bytes), bytes.size(), nullptr, 0);
  return out;
}

Bytes purpose_digest(std::string_view purpose, BytesView bytes) {
  Bytes all = "talkrobots";
  all += '\0';
  all += purpose;
  all += '\0';
  all += bytes;
  return digest(all);
}

Bytes fleet_id(BytesView authority_key) {
  return digest(authority_key).substr(0, 16);
}

SignedRecord sign(std::string_view purpose, std::string_view signer, BytesView fleet, Bytes payload,
                  const SigningKey& key) {
  const Bytes message = signed_bytes(purpose, fleet, payload);
  Bytes signature(crypto_sign_BYTES, '\0');
  crypto_sign_detached(raw(signature), nullptr, raw(message), message.size(), raw(key.secret_key));
  return {std::string(purpose), std::string(signer), {std::move(payload)}, {std::move(signature)}};
}

bool verify(const SignedRecord& record, std::string_view purpose, BytesView fleet, BytesView public_key) {
  if (record.kind != purpose || record.signature.bytes.size() != crypto_sign_BYTES) return false;
  if (public_key.size() != crypto_sign_PUBLICKEYBYTES) return false;
  const Bytes message = signed_bytes(purpose, fleet, record.payload.bytes);
  return crypto_sign_verify_detached(raw(record.signature.bytes), raw(message), message.size(), raw(public_key)) == 0;
}

Result<Certificate> open_certificate_any_time(const SignedRecord& record, const FleetAuthority& authority) {
  auto certificate = decode<Certificate>(record.payload.bytes);
  if (!certificate) return certificate.error();
  if (certificate->fleet.bytes != authority.id()) {
    return fail(Errc::foreign_fleet, "certificate of '" + certificate->id + "' is of another fleet",
                "sign the node's request with this fleet's authority");
  }
  // The signer's name is not signed: a record with one would be a second form of the same certificate.
  if (!record.signer.empty() || !verify(record, kSignedCertificate, authority.id(), authority.public_key)) {
    return fail(Errc::bad_signature,
                "certificate of '" + certificate->id + "' was not signed by this fleet's authority",
                "sign the node's request again");
  }
  if (certificate->identity_key.bytes.size() != 32 || certificate->link_key.bytes.size() != 32) {
    return fail(Errc::malformed, "certificate of '" + certificate->id + "': a key is not 32 bytes");
  }
  return certificate;
}

Result<Certificate> open_certificate(const SignedRecord& record, const FleetAuthority& authority, UtcTime now) {
  auto certificate = open_certificate_any_time(record, authority);
  if (!certificate) return certificate;
  if (Status dates = check_dates(*certificate, now); !dates) return dates.error();
  return certificate;
}

bool has_newer_keys(const Certificate& now, const Certificate& before) {
  return now.id == before.id && now.serial > before.serial && now.identity_key != before.identity_key;
}

Status check_dates(const Certificate& certificate, UtcTime now) {
  if (now.ns < certificate.not_before) {
    return fail(
        Errc::cert_not_yet_valid,
        "certificate of '" + certificate.id + "' is valid from " + to_iso8601({certificate.not_before}) +
            ", and this clock says " + to_iso8601(now),
        "compare with a true clock: if the authority's is ahead, set it, and sign or renew again; if this one is "
        "behind, set it (timedatectl)");
  }
  if (now.ns >= certificate.not_after) {
    return fail(Errc::cert_expired,
                "certificate of '" + certificate.id + "' ended " + to_iso8601({certificate.not_after}),
                "trb fleet renew FLEET_DIR " + certificate.id);
  }
  return Done{};
}

Status check_record(const SignedRecord& record, std::string_view purpose, const Certificate& signer) {
  if (record.signer != signer.id)
    return fail(Errc::source_mismatch, "record of '" + record.signer + "', certificate of '" + signer.id + "'");
  if (!may_sign(signer.role, purpose)) {
    return fail(Errc::not_permitted,
                "role " + std::string(name_of(signer.role)) + " may not sign a " + std::string(purpose));
  }
  if (!verify(record, purpose, signer.fleet.bytes, signer.identity_key.bytes)) {
    return fail(Errc::bad_signature, std::string(purpose) + " of '" + signer.id + "' has a wrong signature");
  }
  return Done{};
}

template <class T>
Result<T> open_record(const SignedRecord& record, std::string_view purpose, const Certificate& signer) {
  if (Status signed_by = check_record(record, purpose, signer); !signed_by) return signed_by.error();
  return decode<T>(record.payload.bytes);
}

template Result<RunStart> open_record(const SignedRecord&, std::string_view, const Certificate&);
template Result<AbortOrder> open_record(const SignedRecord&, std::string_view, const Certificate&);
template Result<TaskResult> open_record(const SignedRecord&, std::string_view, const Certificate&);
template Result<Decision> open_record(const SignedRecord&, std::string_view, const Certificate&);
template Result<PauseOrder> open_record(const SignedRecord&, std::string_view, const Certificate&);
template Result<RunEnd> open_record(const SignedRecord&, std::string_view, const Certificate&);
template Result<Choice> open_record(const SignedRecord&, std::string_view, const Certificate&);

}  // namespace trb
