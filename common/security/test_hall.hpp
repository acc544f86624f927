// A fleet authority's folder and the folders of its nodes, for tests; without a passphrase, whose key derivation is
// slow.
#pragma once

#include <doctest/doctest.h>
#include <stdlib.h>

#include <filesystem>

#include "common/base/files.hpp"
#include "common/base/test/temporary_folder.hpp"
#include "common/security/issued.hpp"
#include "common/security/node_keys.hpp"
#include "common/security/revocations.hpp"
#include "proto/body.hpp"

namespace trb::test {

constexpr UtcTime kNow{1'772'366'400'000'000'000};
constexpr Duration kYear = std::chrono::hours(24 * 365);

struct Hall {
  TemporaryFolder temporary;
  std::string root = temporary.path;
  std::string dir = root + "/fleet";
  Authority authority;

  Hall() {
    init_crypto();
    authority.key = make_signing_key();
    authority.fleet = {"hall", authority.key.public_key};
    authority.beacon = {1, random_bytes(32)};
    REQUIRE(make_dir(dir, 0700).ok());
    REQUIRE(write_fleet(dir, authority).ok());
  }

  [[nodiscard]] std::string keys_of(const std::string& node) const { return root + "/" + node + "/keys"; }
  [[nodiscard]] Result<Authority> read() const { return read_authority(dir); }
  [[nodiscard]] Certificate living(const std::string& id) const { return *find_living(authority, id, kNow); }
  [[nodiscard]] Result<NodeKeys> keys(const std::string& node) const { return load_node_keys(root + "/" + node); }

  /// The certificate request of the node in this folder, under this id.
  SignedRecord request(const std::string& node, const std::string& id, Role role = Role::robot) const {
    REQUIRE(make_request(root + "/" + node, id, role).ok());
    return *from_json<SignedRecord>(*read_file(keys_of(node) + "/request.json"));
  }
  Result<CertificateFile> ask(const std::string& node, const std::string& id) {
    return sign_request(authority, dir, request(node, id), kNow, kYear);
  }
  void join(const std::string& id, Role role = Role::robot) {
    const auto file = sign_request(authority, dir, request(id, id, role), kNow, kYear);
    REQUIRE(file.ok());
    REQUIRE(write_file(keys_of(id) + "/certificate.json", certificate_file_to_json(*file)).ok());
  }
  Status revoke(const std::string& id, const std::string& reason = "stolen") {
    return revoke_certificates(authority, dir, {living(id)}, reason, kNow);
  }
  SignedRecord sign_certificate(const Certificate& certificate) const {
    return sign(kSignedCertificate, "", authority.fleet.id(), encode(certificate), authority.key);
  }
};

template <class T>
Errc code_of(const Result<T>& result) {
  return result.ok() ? Errc::ok : result.error().code;
}

/// The text with the first `from` in it replaced.
inline std::string with(std::string text, std::string_view from, std::string_view to) {
  const auto at = text.find(from);
  REQUIRE(at != std::string::npos);
  return text.replace(at, from.size(), to);
}

}  // namespace trb::test
