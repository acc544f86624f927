#include "common/security/issued.hpp"

#include <algorithm>
#include <map>

#include "common/base/files.hpp"
#include "common/base/hex.hpp"
#include "common/base/ids.hpp"
#include "common/security/revocations.hpp"
#include "proto/body.hpp"
#include "proto/value.hpp"

namespace trb {
namespace {

// A node whose clock is slightly behind must not find its new certificate "not yet valid".
constexpr Duration kClockLeeway = std::chrono::minutes(5);
constexpr Duration kLongestValidity = std::chrono::hours(24 * 36500);
constexpr std::size_t kMaxIssuedFile = 64U << 20U;
constexpr std::size_t kMaxList = 400'000;  // a TrustUpdate must fit into one message
constexpr std::size_t kMaxRenewed = 256;

std::string issued_path(const std::string& dir) {
  return dir + "/issued.json";
}
std::string list_path(const std::string& dir) {
  return dir + "/revocations.json";
}

std::string news_path(const std::string& dir) {
  return dir + "/news.json";
}

void keep_issued(Authority& authority, const Certificate& certificate) {
  authority.next_serial = std::max(authority.next_serial, certificate.serial + 1);
  authority.issued.push_back(certificate);
  std::ranges::stable_sort(authority.issued, {}, &Certificate::serial);
}

Status write_issued(const std::string& dir, const Authority& authority) {
  Value::List rows;
  for (const Certificate& certificate : authority.issued) rows.push_back(*parse_json(to_json(certificate)));
  return write_file(issued_path(dir), dump_json(Value{Value::Object{{"certificates", Value{std::move(rows)}}}}) + "\n");
}

/// The rows first: the next serial follows from them too, while a serial in fleet.json that no row has counts as one of
/// an earlier version.
Status write_numbered(const std::string& dir, const Authority& authority) {
  if (Status stored = write_issued(dir, authority); !stored) return stored;
  return write_fleet(dir, authority);
}

/// Takes the next serial.
Status number_and_date(Authority& authority, Certificate& certificate, UtcTime now, Duration validity) {
  // Beyond it the end would be before 1970: no clock of 64 bits has it.
  if (validity <= Duration::zero() || validity > kLongestValidity) {
    return fail(Errc::bad_value,
                "the certificate of '" + certificate.id + "' would be valid for no time, or for over 36500 days",
                "use --days 1 to 36500");
  }
  certificate.fleet = {authority.fleet.id()};
  certificate.serial = authority.next_serial++;
  certificate.not_before = (now - kClockLeeway).ns;
  certificate.not_after = (now + validity).ns;
  return Done{};
}

SignedRecord sign_certificate(const Authority& authority, const Certificate& certificate) {
  return sign(kSignedCertificate, "", authority.fleet.id(), encode(certificate), authority.key);
}

bool is_issued(const Authority& authority, const Certificate& certificate) {
  return std::find(authority.issued.begin(), authority.issued.end(), certificate) != authority.issued.end();
}

/// A renewal is in news.json before issued.json names it: a process may have been killed in between.
void take_from_news(Authority& authority, const std::string& dir) {
  const auto news = read_trust_updates(news_path(dir));
  if (!news) return;  // none, or it is made anew when it is written
  for (const SignedRecord& record : news->certificates) {
    // To check the signature of each one that is known would take 50 us each.
    if (const auto said = decode<Certificate>(record.payload.bytes); !said || is_issued(authority, *said)) continue;
    const auto certificate = open_certificate_any_time(record, authority.fleet);
    if (!certificate) continue;
    keep_issued(authority, *certificate);
    authority.news_ahead = true;
  }
}

bool same_keys(const Certificate& a, const Certificate& b) {
  return a.identity_key == b.identity_key && a.link_key == b.link_key;
}

/// The newest living certificate of each node.
std::map<std::string, const Certificate*> members(const Authority& authority, UtcTime now) {
  std::map<std::string, const Certificate*> out;
  for (const Certificate& certificate : authority.issued) {
    const Certificate* living = find_living(authority, certificate.id, now);
    if (living != nullptr) out[certificate.id] = living;
  }
  return out;
}

/// True while some certificate that the entry covers would be valid without it.
bool still_needed(const Authority& authority, const Revocation& entry, UtcTime now) {
  return std::any_of(authority.issued.begin(), authority.issued.end(), [&](const Certificate& certificate) {
    return certificate.id == entry.id && certificate.serial <= entry.serial && certificate.not_after > now.ns;
  });
}

void add_entry(RevocationList& list, const Certificate& over, const std::string& reason, UtcTime now) {
  std::erase_if(list.revoked,
                [&](const Revocation& entry) { return entry.id == over.id && entry.serial <= over.serial; });
  const bool covered = find_revocation(list, over) != nullptr;
  if (!covered) list.revoked.push_back({over.serial, over.id, reason, now.ns});
}

Status read_rows(Authority& authority, const std::string& dir) {
  if (!file_exists(issued_path(dir))) return Done{};
  auto text = read_file(issued_path(dir), kMaxIssuedFile);
  if (!text) return text.error();
  auto json = parse_json(*text, {.bytes = kMaxIssuedFile, .depth = 32, .values = 2'000'000});
  const Value* rows = json ? json->find("certificates") : nullptr;
  if (rows == nullptr || !rows->is_list()) {
    return fail(Errc::malformed, issued_path(dir) + ": damaged", "take it from your copy of the folder");
  }
  for (const Value& row : rows->list()) {
    auto certificate = from_json<Certificate>(dump_json(row));
    if (!certificate) return fail(Errc::malformed, issued_path(dir) + ": " + certificate.error().what);
    authority.next_serial = std::max(authority.next_serial, certificate->serial + 1);
    authority.issued.push_back(std::move(*certificate));
  }
  return Done{};
}

}  // namespace

Status write_fleet(const std::string& dir, const Authority& authority) {
  Value::Object out;
  out.emplace_back("name", Value{authority.fleet.name});
  out.emplace_back("authority_key", Value{to_hex(authority.fleet.public_key)});
  out.emplace_back("fleet", Value{to_hex(authority.fleet.id())});
  out.emplace_back("beacon_key_number", Value{static_cast<std::int64_t>(authority.beacon.number)});
  out.emplace_back("next_serial", Value{static_cast<std::int64_t>(authority.next_serial)});
  return write_file(dir + "/fleet.json", dump_json(Value{std::move(out)}) + "\n");
}

Status read_issued(Authority& authority, const std::string& dir) {
  if (Status read = read_rows(authority, dir); !read) return read;
  take_from_news(authority, dir);
  return Done{};
}

Status read_revocations(Authority& authority, const std::string& dir) {
  if (!file_exists(list_path(dir))) return Done{};
  auto text = read_file(list_path(dir));
  if (!text) return text.error();
  auto record = from_json<SignedRecord>(*text);
  if (!record) return fail(Errc::malformed, list_path(dir) + ": " + record.error().what);
  auto list = open_revocations(*record, authority.fleet);
  if (!list) return fail(list.error().code, list_path(dir) + ": " + list.error().what);
  authority.revocations = std::move(*record);
  authority.list = std::move(*list);
  authority.beacon.number = authority.list.beacon_number;
  return Done{};
}

Result<SignedRecord> issue(Authority& authority, const std::string& dir, Certificate certificate, UtcTime now,
                           Duration validity) {
  if (Status good = number_and_date(authority, certificate, now, validity); !good) return good.error();
  authority.issued.push_back(certificate);
  if (Status stored = write_numbered(dir, authority); !stored) return stored.error();
  return sign_certificate(authority, certificate);
}

Status write_revocations(const std::string& dir, const SignedRecord& record) {
  return write_file(list_path(dir), to_json(record) + "\n");
}

const Certificate* find_living(const Authority& authority, std::string_view id, UtcTime now) {
  const Certificate* newest = nullptr;
  for (const Certificate& certificate : authority.issued) {
    if (certificate.id != id || certificate.not_after <= now.ns) continue;
    if (find_revocation(authority.list, certificate) != nullptr) continue;
    if (newest == nullptr || certificate.serial > newest->serial) newest = &certificate;
  }
  return newest;
}

namespace {

Result<CertificateRequest> open_request(const SignedRecord& record) {
  auto request = decode<CertificateRequest>(record.payload.bytes);
  if (!request) return request;
  if (Status good = check_id("id", request->id); !good) return good.error();
  if (verify(record, kSignedRequest, {}, request->identity_key.bytes) && request->link_key.bytes.size() == 32) {
    return request;
  }
  return fail(Errc::bad_signature, "request of '" + request->id + "' was not signed with the key it names",
              "run trb fleet request on the node again");
}

Status refuse_revoked_keys(const Authority& authority, const Certificate& wanted) {
  for (const Certificate& old : authority.issued) {
    const bool shared = old.identity_key == wanted.identity_key || old.link_key == wanted.link_key;
    if (shared && find_revocation(authority.list, old) != nullptr) {
      return fail(Errc::cert_revoked, "the keys of '" + old.id + "' in this request were revoked",
                  "remove identity.key and link.key from the node's keys folder and run trb fleet request again");
    }
  }
  return Done{};
}

Status refuse_second_computer(const Authority& authority, const std::string& dir, const Certificate& wanted,
                              UtcTime now) {
  const Certificate* living = find_living(authority, wanted.id, now);
  if (living == nullptr || same_keys(*living, wanted)) return Done{};
  return fail(Errc::conflict,
              "'" + wanted.id + "' has a certificate (serial " + std::to_string(living->serial) +
                  ") for other keys: is this a new computer?",
              "trb fleet revoke " + dir + " " + wanted.id + " first: the old one must not go on");
}

/// A request proves that its sender has the identity key, and nothing of the link key: a connection proves that one.
/// Keys of a living member under a second name would be revoked with that name, and the member with them.
Status refuse_keys_of_another(const Authority& authority, const Certificate& wanted, UtcTime now) {
  for (const Certificate& other : authority.issued) {
    const bool shared = other.identity_key == wanted.identity_key || other.link_key == wanted.link_key;
    if (!shared || other.id == wanted.id || find_living(authority, other.id, now) != &other) continue;
    return fail(Errc::conflict, "a key in the request of '" + wanted.id + "' is that of '" + other.id + "'",
                "if it is the node '" + other.id + "' itself: correct \"id\" in its node.json to '" + other.id +
                    "', and sign nothing; if not, each node has its own keys: remove identity.key and link.key from "
                    "the keys folder of '" +
                    wanted.id + "' and run trb fleet request again");
  }
  return Done{};
}

}  // namespace

Result<CertificateFile> sign_request(Authority& authority, const std::string& dir, const SignedRecord& record,
                                     UtcTime now, Duration validity, RelayRight relay) {
  const auto request = open_request(record);
  if (!request) return request.error();
  Certificate wanted;
  wanted.id = request->id;
  wanted.role = request->role;
  wanted.identity_key = request->identity_key;
  wanted.link_key = request->link_key;
  wanted.relay = relay == RelayRight::yes || (relay == RelayRight::by_role && request->role == Role::cloud);
  if (Status good = refuse_revoked_keys(authority, wanted); !good) return good.error();
  if (Status good = refuse_second_computer(authority, dir, wanted, now); !good) return good.error();
  if (Status good = refuse_keys_of_another(authority, wanted, now); !good) return good.error();
  auto signed_record = issue(authority, dir, wanted, now, validity);
  if (!signed_record) return signed_record.error();
  CertificateFile file =
      make_certificate_file(*signed_record, authority.fleet, authority.beacon, request->link_key.bytes);
  file.revocations = authority.revocations;
  return file;
}

Result<Certificate> adopt_certificate(Authority& authority, const std::string& dir, const SignedRecord& record) {
  auto certificate = open_certificate_any_time(record, authority.fleet);
  if (!certificate || is_issued(authority, *certificate)) return certificate;
  keep_issued(authority, *certificate);
  if (Status stored = write_issued(dir, authority); !stored) return stored.error();
  return certificate;
}

Result<std::vector<SignedRecord>> renew_certificates(Authority& authority, const std::string& dir,
                                                     const std::vector<Certificate>& old, UtcTime now,
                                                     Duration validity, RelayRight relay) {
  std::vector<Certificate> fresh = old;
  std::vector<SignedRecord> records;
  for (Certificate& next : fresh) {
    if (next.role == Role::cloud) next.relay = true;  // a certificate of an earlier version has no such field
    if (relay != RelayRight::by_role) next.relay = relay == RelayRight::yes;
    if (Status good = number_and_date(authority, next, now, validity); !good) return good.error();
    records.push_back(sign_certificate(authority, next));
  }
  // First of all: of what issued.json names and nobody has, the node would never hear.
  if (Status told = publish_trust_updates(authority, dir, records, now); !told) return told.error();
  authority.issued.insert(authority.issued.end(), fresh.begin(), fresh.end());
  if (Status stored = write_numbered(dir, authority); !stored) return stored.error();
  return records;
}

namespace {

/// The authority's list with those certificates added, and without entries that are no longer needed. It has the number
/// of the next beacon key, not yet the key.
RevocationList next_list(const Authority& authority, const std::vector<Certificate>& over, const std::string& reason,
                         UtcTime now) {
  RevocationList next = authority.list;
  next.fleet = {authority.fleet.id()};
  ++next.number;
  next.issued = now.ns;
  for (const Certificate& certificate : over) add_entry(next, certificate, reason, now);
  std::erase_if(next.revoked, [&](const Revocation& entry) { return !still_needed(authority, entry, now); });
  next.beacon_number = authority.beacon.number + 1;
  next.beacon_keys.clear();
  return next;
}

Result<SignedRecord> sign_list(const Authority& authority) {
  const Result<Bytes> payload = pack(authority.list);
  if (!payload || payload->size() > kMaxList) {
    return fail(Errc::too_large, "the revocation list has over 400 kB, or over 2000 names",
                "give shorter reasons; a fleet has room for about 2000 nodes");
  }
  return sign(kSignedRevocations, "", authority.fleet.id(), *payload, authority.key);
}

}  // namespace

Status revoke_certificates(Authority& authority, const std::string& dir, const std::vector<Certificate>& over,
                           const std::string& reason, UtcTime now) {
  const BeaconKey fresh = derive_beacon_key(authority.key.secret_key, authority.beacon.number + 1);
  const RevocationList before = std::exchange(authority.list, next_list(authority, over, reason, now));
  for (const auto& [id, certificate] : members(authority, now)) {
    authority.list.beacon_keys.push_back({id, {seal_beacon_key(fresh, certificate->link_key.bytes)}});
  }
  const Result<SignedRecord> record = sign_list(authority);
  Status stored = record ? write_revocations(dir, *record) : Status(record.error());
  if (!stored) {
    authority.list = before;
    return stored;
  }
  authority.revocations = *record;
  authority.beacon = fresh;
  // The list counts, and is on disk: fleet.json's beacon key is only a copy.
  (void)write_fleet(dir, authority);
  return Done{};
}

Status check_renewals(std::size_t number) {
  if (number <= kMaxRenewed) return Done{};
  return fail(Errc::too_large, std::to_string(number) + " renewals at once; 256 at most",
              "name some of them, hand these on, then name the others");
}

namespace {

/// Of each node the newest of these that is valid. One that only issued.json names replaces none: it may never have
/// been handed over.
std::vector<SignedRecord> newest_of(const Authority& authority, const std::vector<SignedRecord>& records, UtcTime now) {
  std::vector<std::pair<SignedRecord, Certificate>> valid;
  std::map<std::string, std::uint64_t> newest;
  for (const SignedRecord& record : records) {
    auto certificate = open_certificate_any_time(record, authority.fleet);
    if (!certificate || certificate->not_after <= now.ns) continue;
    if (find_revocation(authority.list, *certificate) != nullptr) continue;
    newest[certificate->id] = std::max(newest[certificate->id], certificate->serial);
    valid.emplace_back(record, std::move(*certificate));
  }
  std::vector<SignedRecord> out;
  for (const auto& [record, certificate] : valid) {
    const bool counts = newest[certificate.id] == certificate.serial;
    if (counts && std::find(out.begin(), out.end(), record) == out.end()) out.push_back(record);
  }
  return out;
}

}  // namespace

Status publish_trust_updates(const Authority& authority, const std::string& dir,
                             const std::vector<SignedRecord>& renewed, UtcTime now) {
  if (Status few = check_renewals(renewed.size()); !few) return few;
  // The list says up to when a revoked certificate is valid by the rows: none may go with its renewal.
  if (Status kept = authority.news_ahead ? write_issued(dir, authority) : Status(Done{}); !kept) return kept;
  std::vector<SignedRecord> all = renewed;
  if (auto old = read_trust_updates(news_path(dir)))
    all.insert(all.end(), old->certificates.begin(), old->certificates.end());
  TrustUpdate update{authority.revocations, newest_of(authority, all, now)};
  update.certificates.resize(std::min(update.certificates.size(), kMaxRenewed));
  return write_trust_updates(news_path(dir), update);
}

}  // namespace trb
