#include "common/security/issued.hpp"

#include <algorithm>
#include <map>

#include "common/base/files.hpp"
#include "common/base/hex.hpp"
#include "common/base/ids.hpp"
#include "common/security/ever_revoked.hpp"
#include "common/security/revocations.hpp"
#include "proto/body.hpp"
#include "proto/value.hpp"

namespace trb {
namespace {

// A node whose clock is slightly behind must not find its new certificate "not yet valid".
constexpr Duration kClockLeeway = std::chrono::minutes(5);
constexpr std::size_t kMaxIssuedFile = 64U << 20U;
constexpr std::size_t kMaxList = 400'000;  // a TrustUpdate must fit into one message

std::string issued_path(const std::string& dir) {
  return dir + "/issued.json";
}
std::string list_path(const std::string& dir) {
  return dir + "/revocations.json";
}

void keep_issued(Authority& authority, const Certificate& certificate) {
  authority.next_serial = std::max(authority.next_serial, certificate.serial + 1);
  authority.issued.push_back(certificate);
  std::ranges::stable_sort(authority.issued, {}, &Certificate::serial);
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

void add_entry(RevocationList& list, const Revocation& entry) {
  const auto covered = [&](const Revocation& row) { return covers(row, entry); };
  std::erase_if(list.revoked, [&](const Revocation& row) { return covers(entry, row); });
  if (std::none_of(list.revoked.begin(), list.revoked.end(), covered)) list.revoked.push_back(entry);
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

std::string news_path(const std::string& dir) {
  return dir + "/news.json";
}

Status write_issued(const std::string& dir, const Authority& authority) {
  Value::List rows;
  for (const Certificate& certificate : authority.issued) rows.push_back(*parse_json(to_json(certificate)));
  return write_file(issued_path(dir), dump_json(Value{Value::Object{{"certificates", Value{std::move(rows)}}}}) + "\n");
}

Status write_fleet(const std::string& dir, const Authority& authority) {
  Value::Object out;
  out.emplace_back("name", Value{authority.fleet.name});
  out.emplace_back("authority_key", Value{to_hex(authority.fleet.public_key)});
  out.emplace_back("fleet", Value{to_hex(authority.fleet.id())});
  out.emplace_back("beacon_key_number", Value{static_cast<std::int64_t>(authority.beacon.number)});
  out.emplace_back("next_serial", Value{static_cast<std::int64_t>(authority.next_serial)});
  if (authority.skipped_to != 0) {
    out.emplace_back("skipped_to", Value{static_cast<std::int64_t>(authority.skipped_to)});
    out.emplace_back("skipped_serials", Value{static_cast<std::int64_t>(authority.skipped)});
  }
  return write_file(dir + "/fleet.json", dump_json(Value{std::move(out)}) + "\n");
}

Status read_issued(Authority& authority, const std::string& dir) {
  if (Status read = read_rows(authority, dir); !read) return read;
  take_from_news(authority, dir);
  return Done{};
}

namespace {

Status read_list(Authority& authority, const std::string& dir) {
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

}  // namespace

void pass_revoked_serials(Authority& authority) {
  for (const auto* entries : {&authority.list.revoked, &authority.revoked}) {
    for (const Revocation& entry : *entries) authority.next_serial = std::max(authority.next_serial, entry.serial + 1);
  }
}

Status read_revocations(Authority& authority, const std::string& dir) {
  if (Status read = read_list(authority, dir); !read) return read;
  if (Status read = read_ever_revoked(authority, dir); !read) return read;
  pass_revoked_serials(authority);
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
    if (find_ever_revoked(authority, certificate) != nullptr) continue;
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

Error keys_were_revoked(const std::string& id) {
  return fail(Errc::cert_revoked, "the keys of '" + id + "' in this request were revoked",
              "remove identity.key and link.key from the node's keys folder and run trb fleet request again");
}

Status refuse_revoked_keys(const Authority& authority, const Certificate& wanted) {
  for (const Certificate& old : authority.issued) {
    const bool shared = old.identity_key == wanted.identity_key || old.link_key == wanted.link_key;
    if (shared && find_ever_revoked(authority, old) != nullptr) return keys_were_revoked(old.id);
  }
  const Revocation* entry = find_revoked_key(authority, wanted);
  return entry == nullptr ? Status(Done{}) : keys_were_revoked(entry->id);
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
  if (!certificate) return certificate;
  if (Status stored = keep_certificates(authority, dir, {*certificate}); !stored) return stored.error();
  return certificate;
}

Status keep_certificates(Authority& authority, const std::string& dir, const std::vector<Certificate>& signed_ones) {
  const std::size_t before = authority.issued.size();
  for (const Certificate& certificate : signed_ones) {
    if (!is_issued(authority, certificate)) keep_issued(authority, certificate);
  }
  return authority.issued.size() == before ? Status(Done{}) : write_issued(dir, authority);
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

/// The authority's list with those certificates added, with what earlier lists had and is still needed, and without
/// entries that are not, as far as they are not named: what is said to be revoked is in the list. It has the number of
/// the next beacon key, not yet the key.
RevocationList next_list(const Authority& authority, const std::vector<Certificate>& over, const std::string& reason,
                         UtcTime now) {
  RevocationList next = authority.list;
  next.fleet = {authority.fleet.id()};
  ++next.number;
  next.issued = now.ns;
  for (Revocation& entry : next.revoked) fill_in(authority, entry);
  std::erase_if(next.revoked, [&](const Revocation& entry) { return !is_needed(authority, entry, now); });
  for (const Revocation& entry : missing_from_list(authority, now)) add_entry(next, entry);
  for (const Certificate& certificate : over) add_entry(next, entry_over(authority, certificate, reason, now));
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
  if (Status kept = remember_list(authority, dir); !kept) return kept;
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

}  // namespace trb
