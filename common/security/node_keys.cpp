#include "common/security/node_keys.hpp"

#include <sodium.h>
#include <sys/stat.h>

#include "common/base/files.hpp"
#include "common/base/hex.hpp"
#include "common/base/ids.hpp"
#include "common/security/certificate_file.hpp"
#include "common/security/revocations.hpp"
#include "proto/body.hpp"

namespace trb {
namespace {

constexpr std::size_t kIdentitySize = 64;
constexpr std::size_t kLinkSize = 32;

std::string keys_dir(const std::string& node_dir) {
  return node_dir + "/keys";
}

/// A secret key: raw bytes, as hexadecimal text, in a file that only its owner may read.
Result<Bytes> read_secret_key(const std::string& path, std::size_t size) {
  // Of a folder that may not be read nobody says that its keys are missing: who made new ones would lose the good ones.
  if (const Status there = look_for(path); !there) {
    if (there.error().code != Errc::missing) return there.error();
    return fail(Errc::missing, there.error().what, "run trb fleet request NODE_DIR");
  }
  struct stat facts {};
  if (::stat(path.c_str(), &facts) != 0) return fail(Errc::io_error, path + ": is gone meanwhile", "try again");
  if ((facts.st_mode & 077U) != 0) {
    return fail(Errc::not_permitted, path + ": others may read this secret key", "run chmod 600 " + path);
  }
  auto text = read_file(path, 4096);
  if (!text) return text.error();
  while (!text->empty() && text->back() == '\n') text->pop_back();
  auto key = from_hex(*text);
  if (!key || key->size() != size)
    return fail(Errc::malformed, path + ": not a key of " + std::to_string(size) + " bytes",
                "remove it and run trb fleet request NODE_DIR, then have it signed");
  return key;
}

Result<SigningKey> read_identity(const std::string& dir) {
  auto secret = read_secret_key(dir + "/identity.key", kIdentitySize);
  if (!secret) return secret.error();
  return SigningKey{secret->substr(32), *secret};
}

Status make_keys(const std::string& dir) {
  if (Status made = make_dir(dir, 0700); !made) return made;
  if (!file_exists(dir + "/identity.key")) {
    if (Status s = write_file(dir + "/identity.key", to_hex(make_signing_key().secret_key) + "\n", 0600); !s) return s;
  }
  if (!file_exists(dir + "/link.key")) {
    if (Status s = write_file(dir + "/link.key", to_hex(make_link_key().secret_key) + "\n", 0600); !s) return s;
  }
  return Done{};
}

/// A node whose certificate expired while it was off starts with the renewal that a person has put beside it.
void take_renewal(const std::string& dir, CertificateFile& file, Certificate& own) {
  const auto update =
      file_exists(dir + "/news.json") ? read_trust_updates(dir + "/news.json") : Result<TrustUpdate>(Error{});
  if (!update) return;  // the router reports what is wrong with it
  for (const SignedRecord& record : update->certificates) {
    auto fresh = open_certificate_any_time(record, file.authority);
    if (!fresh || fresh->id != own.id || fresh->serial <= own.serial) continue;
    if (fresh->identity_key != own.identity_key || fresh->link_key != own.link_key) continue;
    file.certificate = record;
    own = std::move(*fresh);
  }
}

template <typename Loaded>
Result<Certificate> public_part(const Result<Loaded>& loaded) {
  return loaded ? Result<Certificate>(loaded->certificate) : Result<Certificate>(loaded.error());
}

}  // namespace

Result<LinkKey> read_link_key(const std::string& path) {
  auto secret = read_secret_key(path, kLinkSize);
  if (!secret) return secret.error();
  LinkKey key{Bytes(kLinkSize, '\0'), *secret};
  crypto_scalarmult_base(reinterpret_cast<unsigned char*>(key.public_key.data()),
                         reinterpret_cast<const unsigned char*>(key.secret_key.data()));
  return key;
}

Status make_request(const std::string& node_dir, const std::string& id, Role role) {
  if (Status good = check_id("id", id); !good) return good;
  const std::string dir = keys_dir(node_dir);
  if (Status made = make_keys(dir); !made) return made;
  auto identity = read_identity(dir);
  if (!identity) return identity.error();
  auto link = read_link_key(dir + "/link.key");
  if (!link) return link.error();
  const CertificateRequest request{id, role, {identity->public_key}, {link->public_key}};
  const SignedRecord record = sign(kSignedRequest, id, {}, encode(request), *identity);
  return write_file(dir + "/request.json", to_json(record) + "\n");
}

Result<NodeCertificate> load_node_certificate(const std::string& node_dir) {
  const std::string dir = keys_dir(node_dir);
  auto file = read_certificate_file(dir + "/certificate.json");
  if (!file) return file.error();
  auto certificate = open_certificate_any_time(file->certificate, file->authority);
  if (!certificate) return certificate.error();
  take_renewal(dir, *file, *certificate);
  return NodeCertificate{file->certificate, *certificate, file->authority, file->seeds};
}

Result<NodeKeys> load_node_keys(const std::string& node_dir) {
  const std::string dir = keys_dir(node_dir);
  auto identity = read_identity(dir);
  if (!identity) return identity.error();
  auto link = read_link_key(dir + "/link.key");
  if (!link) return link.error();
  auto file = read_certificate_file(dir + "/certificate.json");
  if (!file) return file.error();
  auto certificate = open_certificate_any_time(file->certificate, file->authority);
  if (!certificate) return certificate.error();
  if (certificate->identity_key.bytes != identity->public_key || certificate->link_key.bytes != link->public_key) {
    return fail(Errc::wrong_key, dir + "/certificate.json: made for other keys than those beside it",
                "run trb fleet sign with this node's keys/request.json");
  }
  auto beacon = open_beacon_key(*file, *link);
  if (!beacon) return beacon.error();
  take_renewal(dir, *file, *certificate);
  return NodeKeys{*identity, *link, file->certificate, *certificate, file->authority, *beacon, file->revocations};
}

void check_node_keys(const std::string& node_dir, const std::string& id, UtcTime now, ConfigFaults& faults,
                     bool apart) {
  const auto certificate = apart ? public_part(load_node_certificate(node_dir)) : public_part(load_node_keys(node_dir));
  const std::string file = "keys/certificate.json";
  if (!certificate) {
    faults.push_back({"keys", "", certificate.error().what, certificate.error().hint});
    return;
  }
  if (certificate->id != id) {
    faults.push_back({file, "id", "is for '" + certificate->id + "', node.json says '" + id + "'",
                      "correct \"id\" in node.json to '" + certificate->id + "'; or, if it shall be '" + id +
                          "' from now on: rm keys/identity.key keys/link.key, trb fleet request and trb fleet sign for "
                          "this node, then trb fleet revoke FLEET_DIR " +
                          certificate->id});
  }
  if (now.ns >= certificate->not_after) {
    faults.push_back({file, "not_after", "ended " + to_iso8601({certificate->not_after}),
                      "run trb fleet renew, and put news.json into the keys folder"});
  }
}

}  // namespace trb
