#include "common/security/authority.hpp"

#include <sodium.h>
#include <sys/stat.h>

#include <filesystem>

#include "common/base/files.hpp"
#include "common/base/hex.hpp"
#include "common/base/ids.hpp"
#include "common/security/issued.hpp"
#include "proto/body.hpp"
#include "proto/value.hpp"

namespace trb {
namespace {

constexpr std::size_t kSecretsSize = 64 + 32;  // signing key, beacon key

std::string key_path(const std::string& dir) {
  return dir + "/authority.key";
}
std::string fleet_path(const std::string& dir) {
  return dir + "/fleet.json";
}

/// As its keys/ is.
bool is_inside_node(const std::string& dir) {
  std::error_code none;
  std::filesystem::path whole = std::filesystem::absolute(dir, none).lexically_normal();
  if (!whole.has_filename()) whole = whole.parent_path();
  return file_exists((whole.parent_path() / "node.json").string());
}

/// What to do where no authority is. A node's folder never becomes one: its key would lie on a node.
std::string cure_of_folder(const std::string& dir) {
  const std::string named = "name the authority's folder (that of trb fleet init)";
  return file_exists(dir + "/node.json") ? named : named + ", or make one: trb fleet init " + dir;
}

Status lock_secrets(const std::string& dir, const Authority& authority, const std::string& passphrase) {
  Bytes plain = authority.key.secret_key + authority.beacon.secret;
  auto box = lock_with_passphrase(plain, passphrase);
  sodium_memzero(plain.data(), plain.size());
  if (!box) return box.error();
  return write_file(key_path(dir), to_hex(*box) + "\n", 0600);
}

Result<Bytes> unlock_secrets(const std::string& dir, const std::string& passphrase) {
  struct stat facts {};
  const std::string path = key_path(dir);
  if (::stat(path.c_str(), &facts) != 0) return fail(Errc::missing, path + ": no such file", cure_of_folder(dir));
  if ((facts.st_mode & 077U) != 0)
    return fail(Errc::not_permitted, path + ": others may read it", "run chmod 600 " + path);
  auto text = read_file(path, 4096);
  if (!text) return text.error();
  auto bytes = from_hex(std::string_view(*text).substr(0, text->find('\n')));
  if (!bytes || bytes->size() != kSecretsSize + kPassphraseBoxExtra) return fail(Errc::malformed, path + ": damaged");
  auto plain = open_with_passphrase(*bytes, passphrase, path);
  if (!plain && plain.error().code == Errc::not_permitted) {
    return fail(Errc::not_permitted, path + ": the passphrase is wrong",
                "try again, or see README.md: The authority's key is lost");
  }
  return plain;
}

Result<Value> read_fleet_json(const std::string& dir) {
  auto text = read_file(fleet_path(dir), 65536);
  if (!text) return fail(text.error().code, text.error().what, cure_of_folder(dir));
  auto json = parse_json(*text);
  if (!json) return fail(json.error().code, fleet_path(dir) + ": " + json.error().what);
  return json;
}

/// 0, if it is not there: only a folder that was restored has it.
std::uint64_t number_in(const Value& json, const std::string& key) {
  const Value* member = json.find(key);
  return member != nullptr && member->is_integer() ? static_cast<std::uint64_t>(member->integer()) : 0;
}

}  // namespace

Result<Authority> make_authority(const std::string& dir, const std::string& name, const std::string& passphrase) {
  if (Status good = check_id("name", name); !good) return good.error();
  if (passphrase.size() < kMinPassphrase) {
    return fail(Errc::bad_value, "passphrase: under " + std::to_string(kMinPassphrase) + " characters",
                "take a longer one");
  }
  if (file_exists(dir + "/node.json") || is_inside_node(dir)) {
    return fail(Errc::conflict, dir + ": is a node's folder, or in one, and the authority's key lies on no node",
                "name a folder of its own");
  }
  if (file_exists(key_path(dir)) && !file_exists(fleet_path(dir))) {
    return fail(Errc::conflict, dir + ": " + key_path(dir) + " is there, " + fleet_path(dir) + " is not",
                "if trb fleet init was ended half way: rm " + key_path(dir) +
                    ", then run it again; if not: put the file back from the folder's copy");
  }
  if (file_exists(key_path(dir)) || file_exists(fleet_path(dir))) {
    return fail(Errc::conflict, dir + ": holds a fleet authority already", "name another folder");
  }
  if (Status made = make_dir(dir, 0700); !made) return made.error();
  Authority authority;
  authority.key = make_signing_key();
  authority.fleet = {name, authority.key.public_key};
  authority.beacon = {1, random_bytes(32)};
  if (Status s = lock_secrets(dir, authority, passphrase); !s) return s.error();
  if (Status s = write_fleet(dir, authority); !s) return s.error();
  return authority;
}

Result<FleetAuthority> read_fleet(const std::string& dir) {
  auto json = read_fleet_json(dir);
  if (!json) return json.error();
  const Value* name = json->find("name");
  const Value* key = json->find("authority_key");
  if (name == nullptr || !name->is_text() || key == nullptr || !key->is_text()) {
    return fail(Errc::malformed, fleet_path(dir) + ": name or authority_key missing");
  }
  auto bytes = from_hex(key->text());
  if (!bytes || bytes->size() != 32) return fail(Errc::malformed, fleet_path(dir) + ": authority_key: not 32 bytes");
  return FleetAuthority{name->text(), *bytes};
}

Result<Authority> read_authority(const std::string& dir) {
  auto fleet = read_fleet(dir);
  if (!fleet) return fleet.error();
  auto json = read_fleet_json(dir);
  const Value* serial = json->find("next_serial");
  const Value* number = json->find("beacon_key_number");
  if (serial == nullptr || !serial->is_integer() || number == nullptr || !number->is_integer()) {
    return fail(Errc::malformed, fleet_path(dir) + ": next_serial or beacon_key_number missing");
  }
  Authority authority;
  authority.fleet = *fleet;
  authority.beacon.number = static_cast<std::uint32_t>(number->integer());
  authority.next_serial = static_cast<std::uint64_t>(serial->integer());
  authority.skipped_to = number_in(*json, "skipped_to");
  authority.skipped = number_in(*json, "skipped_serials");
  if (Status read = read_issued(authority, dir); !read) return read.error();
  if (Status read = read_revocations(authority, dir); !read) return read.error();
  return authority;
}

Result<Authority> open_authority(const std::string& dir, const std::string& passphrase) {
  auto fleet = read_fleet(dir);
  if (!fleet) return fleet.error();
  auto secret = unlock_secrets(dir, passphrase);
  if (!secret) return secret.error();
  auto authority = read_authority(dir);
  if (!authority) return authority;
  authority->key = {secret->substr(32, 32), secret->substr(0, 64)};
  // A list brought a new one, derived from the authority's key; the first one is stored.
  authority->beacon.secret = authority->revocations.kind.empty()
                                 ? secret->substr(64)
                                 : derive_beacon_key(authority->key.secret_key, authority->beacon.number).secret;
  if (authority->key.public_key != fleet->public_key) {
    return fail(Errc::wrong_key, dir + ": fleet.json and authority.key do not belong together");
  }
  return authority;
}

}  // namespace trb
