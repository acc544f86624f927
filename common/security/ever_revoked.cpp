#include "common/security/ever_revoked.hpp"

#include <algorithm>
#include <limits>

#include "common/base/files.hpp"
#include "common/base/hex.hpp"
#include "common/security/revocations.hpp"
#include "proto/value.hpp"

namespace trb {
namespace {

constexpr std::size_t kMaxFile = 64U << 20U;
constexpr std::int64_t kNever = std::numeric_limits<std::int64_t>::max();

std::string path_in(const std::string& dir) {
  return dir + "/revoked.json";
}

std::int64_t later(std::int64_t time, Duration more) {
  return time > kNever - more.count() ? kNever : time + more.count();
}

bool has_keys(const Revocation& entry) {
  return !entry.identity.bytes.empty();
}

bool same_keys(const Revocation& a, const Revocation& b) {
  return a.identity == b.identity && a.link == b.link;
}

Bytes first_of(const Blob& key) {
  return key.bytes.substr(0, kRevokedKey);
}

/// Until when what it covers is valid, as far as the rows of issued.json and the entry itself say; 0: they do not.
std::int64_t known_end(const Authority& authority, const Revocation& entry) {
  std::int64_t end = entry.until;
  bool is_known = end != 0;
  for (const Certificate& row : authority.issued) {
    if (row.id != entry.id || row.serial > entry.serial) continue;
    end = std::max(end, row.not_after);
    is_known = is_known || row.serial == entry.serial;
  }
  return is_known ? end : 0;
}

void remember(std::vector<Revocation>& memory, const Revocation& entry) {
  const auto at = std::find_if(memory.begin(), memory.end(), [&](const Revocation& row) {
    return row.id == entry.id && row.serial == entry.serial && (same_keys(row, entry) || !has_keys(row));
  });
  if (at == memory.end()) return memory.push_back(entry);
  const std::int64_t until = std::max(at->until, entry.until);
  *at = entry;
  at->until = until;
}

Value to_value(const Revocation& entry) {
  return Value{Value::Object{{"id", Value{entry.id}},
                             {"serial", Value{static_cast<std::int64_t>(entry.serial)}},
                             {"reason", Value{entry.reason}},
                             {"at", Value{entry.at}},
                             {"until", Value{entry.until}},
                             {"identity", Value{to_hex(entry.identity.bytes)}},
                             {"link", Value{to_hex(entry.link.bytes)}}}};
}

std::optional<std::string> text_of(const Value& row, const std::string& key) {
  const Value* member = row.find(key);
  return member != nullptr && member->is_text() ? std::optional(member->text()) : std::nullopt;
}

std::optional<std::int64_t> integer_of(const Value& row, const std::string& key) {
  const Value* member = row.find(key);
  return member != nullptr && member->is_integer() ? std::optional(member->integer()) : std::nullopt;
}

std::optional<Bytes> key_of(const Value& row, const std::string& key) {
  const auto text = text_of(row, key);
  if (!text) return std::nullopt;
  const auto bytes = from_hex(*text);
  return bytes && bytes->size() <= kRevokedKey ? std::optional(*bytes) : std::nullopt;
}

std::optional<Revocation> entry_in(const Value& row) {
  if (!row.is_object()) return std::nullopt;
  const auto id = text_of(row, "id");
  const auto reason = text_of(row, "reason");
  const auto serial = integer_of(row, "serial");
  const auto at = integer_of(row, "at");
  const auto until = integer_of(row, "until");
  const auto identity = key_of(row, "identity");
  const auto link = key_of(row, "link");
  if (!id || !reason || !serial || !at || !until || !identity || !link) return std::nullopt;
  return Revocation{static_cast<std::uint64_t>(*serial), *id, *reason, *at, *until, {*identity}, {*link}};
}

}  // namespace

const Revocation* find_ever_revoked(const Authority& authority, const Certificate& certificate) {
  if (const Revocation* entry = find_revocation(authority.list, certificate)) return entry;
  const auto at = std::find_if(authority.revoked.begin(), authority.revoked.end(), [&](const Revocation& entry) {
    return entry.id == certificate.id && entry.serial >= certificate.serial;
  });
  return at == authority.revoked.end() ? nullptr : &*at;
}

const Revocation* find_revoked_key(const Authority& authority, const Certificate& certificate) {
  const Bytes identity = first_of(certificate.identity_key);
  const Bytes link = first_of(certificate.link_key);
  for (const auto* entries : {&authority.list.revoked, &authority.revoked}) {
    for (const Revocation& entry : *entries) {
      if (has_keys(entry) && (entry.identity.bytes == identity || entry.link.bytes == link)) return &entry;
    }
  }
  return nullptr;
}

Revocation entry_over(const Authority& authority, const Certificate& certificate, const std::string& reason,
                      UtcTime now) {
  Revocation entry{certificate.serial, certificate.id, reason, now.ns};
  entry.identity = {first_of(certificate.identity_key)};
  entry.link = {first_of(certificate.link_key)};
  if (certificate.serial <= authority.skipped_to) {
    // A newer copy of this folder may have signed others of this id: they end nobody knows when, and not after that.
    constexpr Duration longest = kLongestValidity;
    entry.serial = authority.skipped_to;
    entry.until = std::max(certificate.not_after, later(now.ns, longest));
  } else {
    entry.until = std::max(certificate.not_after, known_end(authority, entry));
  }
  return entry;
}

void fill_in(const Authority& authority, Revocation& entry) {
  for (const Certificate& row : authority.issued) {
    if (has_keys(entry) || row.id != entry.id || row.serial != entry.serial) continue;
    entry.identity = {first_of(row.identity_key)};
    entry.link = {first_of(row.link_key)};
  }
  entry.until = known_end(authority, entry);
}

bool is_needed(const Authority& authority, const Revocation& entry, UtcTime now) {
  constexpr Duration longest = kLongestValidity;
  const std::int64_t end = known_end(authority, entry);
  return later(end != 0 ? end : later(entry.at, longest), kEndLeeway) > now.ns;
}

std::vector<Revocation> missing_from_list(const Authority& authority, UtcTime now) {
  std::vector<Revocation> out = not_in_list(authority.list, authority.revoked);
  std::erase_if(out, [&](const Revocation& entry) { return !is_needed(authority, entry, now); });
  return out;
}

Status remember_list(Authority& authority, const std::string& dir) {
  for (const Revocation& entry : authority.list.revoked) {
    Revocation filled = entry;
    fill_in(authority, filled);
    remember(authority.revoked, filled);
  }
  if (authority.revoked.empty()) return Done{};
  Value::List rows;
  for (const Revocation& entry : authority.revoked) rows.push_back(to_value(entry));
  return write_file(path_in(dir), dump_json(Value{Value::Object{{"revoked", Value{std::move(rows)}}}}) + "\n");
}

Status read_ever_revoked(Authority& authority, const std::string& dir) {
  if (!file_exists(path_in(dir))) return Done{};
  auto text = read_file(path_in(dir), kMaxFile);
  if (!text) return text.error();
  auto json = parse_json(*text, {.bytes = kMaxFile, .depth = 32, .values = 4'000'000});
  const Value* rows = json ? json->find("revoked") : nullptr;
  const Error damaged = fail(Errc::malformed, path_in(dir) + ": damaged", "take it from your copy of the folder");
  if (rows == nullptr || !rows->is_list()) return damaged;
  for (const Value& row : rows->list()) {
    const auto entry = entry_in(row);
    if (!entry) return damaged;
    remember(authority.revoked, *entry);
  }
  return Done{};
}

}  // namespace trb
