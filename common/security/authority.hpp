// The fleet authority's folder (`trb fleet init`): the signing key, encrypted with a passphrase, and the beacon key. No
// node has this folder.
#pragma once

#include <string>
#include <vector>

#include "common/security/certificate_file.hpp"
#include "common/security/passphrase_box.hpp"
#include "proto/bodies/link.hpp"

namespace trb {

struct Authority {
  FleetAuthority fleet;
  SigningKey key;
  BeaconKey beacon;
  std::uint64_t next_serial = 1;
  /// Up to this one a newer copy of this folder may have given serials that nobody has told to this one; 0: none has.
  std::uint64_t skipped_to = 0;
  std::uint64_t skipped = 0;        ///< how many were passed over for that
  std::vector<Certificate> issued;  ///< every certificate in issued.json, oldest first
  bool news_ahead = false;          ///< some of them are in news.json, and not in issued.json yet
  SignedRecord revocations;         ///< the newest list; an empty kind for none
  RevocationList list;              ///< its content
  std::vector<Revocation> revoked;  ///< those of earlier lists, too, for ever
};

constexpr Duration kLongestValidity = std::chrono::hours(24 * 36500);

/// May the node carry messages between members that cannot reach each other? By its role: a cloud may.
enum class RelayRight : unsigned char { by_role, yes, no };

/// Makes fleet.json (public) and authority.key (0600, argon2id + XSalsa20-Poly1305). Errors: conflict if there is one
/// already or the folder is a node's, bad_value (passphrase under kMinPassphrase characters), io_error.
Result<Authority> make_authority(const std::string& dir, const std::string& name, const std::string& passphrase);

/// Errors: missing, malformed, not_permitted (file mode, or the passphrase is wrong).
Result<Authority> open_authority(const std::string& dir, const std::string& passphrase);

/// The public half, no passphrase needed.
Result<FleetAuthority> read_fleet(const std::string& dir);

/// The part of the folder that needs no passphrase: issued certificates, revocations; the keys stay empty. Errors:
/// missing, malformed.
Result<Authority> read_authority(const std::string& dir);

/// Checks a request's proof of possession and signs a certificate; takes and stores the next serial number, and keeps
/// the certificate in issued.json. Errors: malformed, bad_signature, bad_value, conflict (a current certificate of that
/// id has other keys, or another id's has one of these), cert_revoked (these keys were revoked once), io_error.
Result<CertificateFile> sign_request(Authority& authority, const std::string& dir, const SignedRecord& request,
                                     UtcTime now, Duration validity, RelayRight relay = RelayRight::by_role);

/// The newest certificate of that id that is neither expired nor was ever revoked, or nullptr.
const Certificate* find_living(const Authority& authority, std::string_view id, UtcTime now);

/// Adds a certificate that a folder of an earlier version signed but did not keep. Errors: those of
/// open_certificate_any_time, io_error.
Result<Certificate> adopt_certificate(Authority& authority, const std::string& dir, const SignedRecord& record);

/// Takes over what the fleet has from this authority and this folder, restored from an older copy, lacks: certificates,
/// a newer list, so that nothing revoked becomes valid again and no number is used twice. Serials go on far behind the
/// highest one that is known: others may have been given. Two lists with the same number are merged into the next one.
/// Returns whether there was anything. Errors: those of adopt_certificate and open_revocations, io_error.
Result<bool> catch_up(Authority& authority, const std::string& dir, const TrustUpdate& known);

/// New certificates for the same nodes and keys, with the next serials; with by_role each keeps an existing right to
/// relay. They are in news.json before issued.json names them: what was signed can be told, whenever this is
/// interrupted. Errors: too_large (over 256), bad_value (`validity`), io_error.
Result<std::vector<SignedRecord>> renew_certificates(Authority& authority, const std::string& dir,
                                                     const std::vector<Certificate>& old, UtcTime now,
                                                     Duration validity, RelayRight relay = RelayRight::by_role);

/// The next list: it adds these certificates, also those that have ended, and all that was ever revoked and is still
/// needed; it brings every node that stays a new beacon key. It is in force for the authority once this returns.
/// Errors: too_large (over 400 kB, or 2000 names of either kind), io_error.
Status revoke_certificates(Authority& authority, const std::string& dir, const std::vector<Certificate>& over,
                           const std::string& reason, UtcTime now);

/// Before they are signed. Errors: too_large (over 256, for which news.json has no room).
Status check_renewals(std::size_t number);

/// Writes FLEET_DIR/news.json: the newest list, these renewed certificates, and those in the file that are still valid
/// and that none of these replaces. What only that file has is written to issued.json before.
/// Errors: too_large (over 256 renewals), io_error.
Status publish_trust_updates(const Authority& authority, const std::string& dir,
                             const std::vector<SignedRecord>& renewed, UtcTime now);

}  // namespace trb
