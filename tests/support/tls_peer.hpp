// A robot's end of TLS in memory, and certificates of every kind, by OpenSSL's own calls.
#pragma once

#include <arpa/inet.h>
#include <openssl/evp.h>
#include <openssl/pem.h>
#include <openssl/ssl.h>
#include <openssl/x509v3.h>

#include <memory>
#include <string>
#include <utility>

namespace trb::test {

using Key = std::shared_ptr<EVP_PKEY>;
using Certificate = std::shared_ptr<X509>;

struct Identity {
  Key key;
  Certificate certificate;
};

struct Wish {
  std::string subject = "ABB";
  std::string names = "IP:127.0.27.1";  ///< as openssl.cnf writes them
  long from_s = -3600;
  long until_s = 3600;
  const Identity* by = nullptr;  ///< the authority; itself
  bool is_authority = false;
};

inline void add_extension(X509* certificate, int kind, const std::string& value) {
  X509_EXTENSION* const extension = X509V3_EXT_conf_nid(nullptr, nullptr, kind, value.c_str());
  X509_add_ext(certificate, extension, -1);
  X509_EXTENSION_free(extension);
}

inline Identity make_identity(const Wish& wish) {
  Identity out{Key(EVP_EC_gen("P-256"), EVP_PKEY_free), Certificate(X509_new(), X509_free)};
  X509* const it = out.certificate.get();
  X509_set_version(it, X509_VERSION_3);
  static long serial = 1;
  ASN1_INTEGER_set(X509_get_serialNumber(it), serial++);
  X509_gmtime_adj(X509_getm_notBefore(it), wish.from_s);
  X509_gmtime_adj(X509_getm_notAfter(it), wish.until_s);
  X509_NAME_add_entry_by_NID(X509_get_subject_name(it), NID_commonName, MBSTRING_UTF8,
                             reinterpret_cast<const unsigned char*>(wish.subject.c_str()), -1, -1, 0);
  const Identity& by = wish.by == nullptr ? out : *wish.by;
  X509_set_issuer_name(it, X509_get_subject_name(by.certificate.get()));
  X509_set_pubkey(it, out.key.get());
  add_extension(it, NID_basic_constraints, wish.is_authority ? "critical,CA:TRUE" : "critical,CA:FALSE");
  if (!wish.names.empty()) add_extension(it, NID_subject_alt_name, wish.names);
  X509_sign(it, by.key.get(), EVP_sha256());
  return out;
}

inline std::string pem_of(const Identity& identity) {
  BIO* const memory = BIO_new(BIO_s_mem());
  PEM_write_bio_X509(memory, identity.certificate.get());
  char* bytes = nullptr;
  const long size = BIO_get_mem_data(memory, &bytes);
  std::string out(bytes, static_cast<std::size_t>(size));
  BIO_free_all(memory);
  return out;
}

/// "AB:CD:...", by a way of its own.
inline std::string fingerprint_of(const Identity& identity) {
  unsigned char digest[EVP_MAX_MD_SIZE];
  unsigned size = 0;
  X509_digest(identity.certificate.get(), EVP_sha256(), digest, &size);
  std::string out;
  for (unsigned i = 0; i < size; ++i) {
    char two[4];
    std::snprintf(two, sizeof two, "%s%02X", i == 0 ? "" : ":", digest[i]);
    out += two;
  }
  return out;
}

class TlsPeer {
 public:
  explicit TlsPeer(const Identity& identity, int most = TLS1_3_VERSION)
      : context_(SSL_CTX_new(TLS_server_method()), SSL_CTX_free) {
    SSL_CTX_set_security_level(context_.get(), 0);
    SSL_CTX_set_max_proto_version(context_.get(), most);
    SSL_CTX_use_certificate(context_.get(), identity.certificate.get());
    SSL_CTX_use_PrivateKey(context_.get(), identity.key.get());
    ssl_.reset(SSL_new(context_.get()), SSL_free);
    in_ = BIO_new(BIO_s_mem());
    out_ = BIO_new(BIO_s_mem());
    SSL_set_bio(ssl_.get(), in_, out_);
    SSL_set_accept_state(ssl_.get());
  }
  /// What it has read in plain is added to `heard`.
  void take(const std::string& bytes) {
    BIO_write(in_, bytes.data(), static_cast<int>(bytes.size()));
    if (SSL_is_init_finished(ssl_.get()) == 0 && SSL_do_handshake(ssl_.get()) != 1) return;
    char buffer[4096];
    for (int got = 0; (got = SSL_read(ssl_.get(), buffer, sizeof buffer)) > 0;)
      heard.append(buffer, static_cast<std::size_t>(got));
  }
  void say(const std::string& plain) { SSL_write(ssl_.get(), plain.data(), static_cast<int>(plain.size())); }
  void end() { SSL_shutdown(ssl_.get()); }
  std::string to_send() {
    std::string out(BIO_ctrl_pending(out_), '\0');
    if (!out.empty()) BIO_read(out_, out.data(), static_cast<int>(out.size()));
    return out;
  }
  /// The other end has said that it writes no more.
  bool ended() const { return (SSL_get_shutdown(ssl_.get()) & SSL_RECEIVED_SHUTDOWN) != 0; }
  bool ready() const { return SSL_is_init_finished(ssl_.get()) == 1; }

  std::string heard;

 private:
  std::shared_ptr<SSL_CTX> context_;
  std::shared_ptr<SSL> ssl_;
  BIO* in_ = nullptr;
  BIO* out_ = nullptr;
};

}  // namespace trb::test
