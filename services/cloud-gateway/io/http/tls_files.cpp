#include "services/cloud-gateway/io/http/tls_files.hpp"

#include <cstdio>

#include "common/base/files.hpp"
#include "services/cloud-gateway/io/http/self_signed.hpp"

namespace trb::gateway {
namespace {

constexpr std::size_t kMaxPem = 64U << 10U;  // a long chain has 20 kB

struct Paths {
  explicit Paths(const std::string& node_dir)
      : folder(node_dir + "/keys"), files{folder + "/gateway.crt", folder + "/gateway.key", {}} {}
  std::string folder;
  TlsFiles files;
  /// The key until its certificate is there: a crash before that leaves nothing that a start would miss.
  std::string staged_key = files.key + ".staged";
};

Status put_key_in_place(const Paths& paths) {
  if (std::rename(paths.staged_key.c_str(), paths.files.key.c_str()) == 0) return Done{};
  return fail(Errc::io_error, paths.files.key + ": cannot rename " + paths.staged_key + " to it",
              "see that this process may write the folder keys");
}

Status make_files(const Paths& paths, const std::vector<std::string>& names, UtcTime now) {
  const auto made = make_self_signed(names, now);
  if (!made) return made.error();
  if (!file_exists(paths.folder))
    if (Status folder = make_dir(paths.folder, 0700); !folder) return folder;
  if (Status key = write_file(paths.staged_key, made->key, 0600); !key) return key;
  if (Status certificate = write_file(paths.files.certificate, made->certificate, 0644); !certificate)
    return certificate;
  return put_key_in_place(paths);
}

bool is_pair(const Paths& paths, const std::string& key_file) {
  const auto certificate = read_file(paths.files.certificate, kMaxPem);
  const auto key = read_file(key_file, kMaxPem);
  return certificate && key && is_key_of(*certificate, *key);
}

/// A start that was cut off between the two files left the key staged.
Status finish_earlier_start(const Paths& paths) {
  if (is_pair(paths, paths.staged_key)) return put_key_in_place(paths);
  return fail(Errc::missing, paths.files.key + ": no such file, but " + paths.files.certificate + " is there",
              "put the certificate's key there, or remove the certificate: then both are made anew");
}

Result<CertificateFacts> facts_of_file(const std::string& certificate_file) {
  const auto pem = read_file(certificate_file, kMaxPem);
  if (!pem) return pem.error();
  auto facts = facts_of(*pem);
  if (!facts) return fail(Errc::malformed, certificate_file + ": " + facts.error().what, facts.error().hint);
  return facts;
}

/// Both files are there. A renewal that was cut off between the two is finished first.
Status renew(const Paths& paths, const std::vector<std::string>& names, UtcTime now) {
  if (!is_pair(paths, paths.files.key) && is_pair(paths, paths.staged_key)) return put_key_in_place(paths);
  const auto facts = facts_of_file(paths.files.certificate);
  if (!facts) return facts.error();
  if (facts->is_own && facts->ends - kRenewBefore < now) return make_files(paths, names, now);
  const auto key = read_file(paths.files.key, kMaxPem);
  if (!key) return fail(key.error().code, key.error().what, "put a PEM file there that this process may read");
  if (!is_private_key(*key))
    return fail(Errc::malformed, paths.files.key + ": is no private key in PEM without a passphrase",
                "put the certificate's key there, without a passphrase (openssl pkey -in KEY -out gateway.key)");
  if (is_pair(paths, paths.files.key)) return Done{};
  return fail(
      Errc::wrong_key,
      paths.files.key + ": is not the key of " + paths.files.certificate + "; it belongs to another certificate",
      "put that certificate's own key there, or remove both files: then both are made anew");
}

}  // namespace

Result<TlsFiles> provide_tls_files(const std::string& node_dir, const std::vector<std::string>& names, UtcTime now) {
  const Paths paths(node_dir);
  const bool has_certificate = file_exists(paths.files.certificate);
  const bool has_key = file_exists(paths.files.key);
  if (has_key && !has_certificate)
    return fail(Errc::missing, paths.files.certificate + ": no such file, but " + paths.files.key + " is there",
                "put the key's certificate there, or remove the key: then both are made anew");
  Status ready = Done{};
  if (!has_certificate) ready = make_files(paths, names, now);
  if (has_certificate && !has_key) ready = finish_earlier_start(paths);
  if (has_certificate && has_key) ready = renew(paths, names, now);
  if (!ready) return ready.error();
  const auto facts = facts_of_file(paths.files.certificate);
  if (!facts) return facts.error();
  TlsFiles out = paths.files;
  out.ends = facts->ends;
  return out;
}

Result<std::string> fingerprint(const std::string& certificate_file) {
  const auto pem = read_file(certificate_file, kMaxPem);
  if (!pem) return fail(Errc::io_error, pem.error().what, "start the gateway once: it makes its certificate");
  auto digest = fingerprint_of(*pem);
  if (!digest) return fail(Errc::malformed, certificate_file + ": " + digest.error().what, digest.error().hint);
  return digest;
}

}  // namespace trb::gateway
