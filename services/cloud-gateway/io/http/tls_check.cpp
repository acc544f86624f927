#include "services/cloud-gateway/io/http/tls_check.hpp"

#include <sys/stat.h>

#include <optional>
#include <utility>

#include "common/base/files.hpp"
#include "services/cloud-gateway/io/http/self_signed.hpp"

namespace trb::gateway {
namespace {

constexpr std::size_t kMostPem = 64U << 10U;
constexpr const char* kCertificateFile = "keys/gateway.crt";
constexpr const char* kKeyFile = "keys/gateway.key";
constexpr const char* kMadeAnew = "remove both files: then both are made anew";

bool is_open_to_others(const std::string& path) {
  struct stat facts {};
  return ::stat(path.c_str(), &facts) == 0 && (facts.st_mode & 077U) != 0;
}

class TlsChecker {
 public:
  TlsChecker(std::string node_dir, UtcTime now) : dir_(std::move(node_dir) + "/"), now_(now) {}

  ConfigFaults check() && {
    const bool has_certificate = file_exists(dir_ + kCertificateFile);
    const bool has_key = file_exists(dir_ + kKeyFile);
    const auto certificate = has_certificate ? read(kCertificateFile) : std::nullopt;
    if (certificate) look_at(*certificate);
    const auto key = has_key ? read(kKeyFile) : std::nullopt;
    if (key) look_at_key(*key);
    if (has_certificate && !has_key && (!certificate || !is_staged(*certificate)))
      add(kKeyFile, std::string("no such file, but ") + kCertificateFile + " is there",
          "put the certificate's key there, or remove the certificate: then both are made anew");
    if (has_key && !has_certificate)
      add(kCertificateFile, std::string("no such file, but ") + kKeyFile + " is there",
          "put the key's certificate there, or remove the key: then both are made anew");
    if (certificate && key && is_private_key(*key) && facts_of(*certificate) && !is_key_of(*certificate, *key) &&
        !is_staged(*certificate))
      add(kKeyFile, std::string("is not the key of ") + kCertificateFile,
          std::string("put that certificate's own key there, or ") + kMadeAnew);
    return std::move(out_);
  }

 private:
  void add(const std::string& file, std::string what, std::string cure) {
    out_.push_back({file, "", std::move(what), std::move(cure)});
  }

  std::optional<std::string> read(const std::string& file) {
    auto text = read_file(dir_ + file, kMostPem);
    if (text) return std::move(*text);
    add(file, text.error().what, std::string("put a PEM file there that the node's user may read, or ") + kMadeAnew);
    return std::nullopt;
  }

  void look_at(const std::string& certificate) {
    const auto facts = facts_of(certificate);
    if (!facts)
      return add(kCertificateFile, facts.error().what, std::string("put a certificate in PEM there, or ") + kMadeAnew);
    if (facts->ends > now_) return;
    add(kCertificateFile, "ended " + to_iso8601(facts->ends) + ": no browser takes it",
        facts->is_own ? std::string("restart the node: it makes a new one")
                      : std::string("put a new one there, and its key, or ") + kMadeAnew);
  }

  void look_at_key(const std::string& key) {
    if (is_open_to_others(dir_ + kKeyFile))
      add(kKeyFile, "others may read this secret key",
          "run chmod 600 " + dir_ + kKeyFile + "; if others could, take a new key");
    if (!is_private_key(key)) {
      return add(kKeyFile, "is no private key in PEM without a passphrase",
                 "put the certificate's key there, without a passphrase (openssl pkey -in KEY -out gateway.key)");
    }
    if (is_weak_key(key))
      add(kKeyFile, "is too weak a key: TLS does not take it",
          std::string("take one of EC P-256, or of RSA with 2048 bits; or ") + kMadeAnew);
  }

  /// A start that was cut off between the two files left the key staged; the next start finishes it.
  bool is_staged(const std::string& certificate) const {
    const auto key = read_file(dir_ + kKeyFile + ".staged", kMostPem);
    return key && is_key_of(certificate, *key);
  }

  std::string dir_;
  UtcTime now_;
  ConfigFaults out_;
};

}  // namespace

ConfigFaults check_tls_files(const std::string& node_dir, UtcTime now) {
  return TlsChecker(node_dir, now).check();
}

}  // namespace trb::gateway
