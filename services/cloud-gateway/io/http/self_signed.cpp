#include "services/cloud-gateway/io/http/self_signed.hpp"

#include <arpa/inet.h>
#include <openssl/bio.h>
#include <openssl/bn.h>
#include <openssl/evp.h>
#include <openssl/pem.h>
#include <openssl/rand.h>
#include <openssl/x509.h>
#include <openssl/x509v3.h>

#include <algorithm>
#include <memory>

#include "common/tls/freed.hpp"
#include "common/tls/peer_certificate.hpp"

namespace trb::gateway {
namespace {

using Key = std::unique_ptr<EVP_PKEY, Freed<EVP_PKEY_free>>;
using Certificate = std::unique_ptr<X509, Freed<X509_free>>;
using Extension = std::unique_ptr<X509_EXTENSION, Freed<X509_EXTENSION_free>>;
using Names = std::unique_ptr<GENERAL_NAMES, Freed<GENERAL_NAMES_free>>;
using Memory = std::unique_ptr<BIO, Freed<BIO_free_all>>;
using Number = std::unique_ptr<BIGNUM, Freed<BN_free>>;

constexpr std::string_view kCommonName = "TalkRoBots gateway";
constexpr long kBackdate_s = 3600;
constexpr long kDay_s = 24L * 3600L;
constexpr std::size_t kSerialBytes = 8;

/// What a host name is made of (RFC 952, RFC 1123); 253: RFC 1035.
bool is_host_name(std::string_view name) {
  const auto may_stand = [](char c) {
    return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '-' || c == '.';
  };
  return !name.empty() && name.size() <= 253 && std::ranges::all_of(name, may_stand);
}

/// The bytes of a numeric address; empty: it is none.
Bytes address_bytes(const std::string& text) {
  unsigned char room[sizeof(in6_addr)];
  for (const auto& [family, size] : {std::pair(AF_INET, sizeof(in_addr)), std::pair(AF_INET6, sizeof(in6_addr))})
    if (::inet_pton(family, text.c_str(), room) == 1) return {reinterpret_cast<const char*>(room), size};
  return {};
}

bool add_name(GENERAL_NAMES* names, int type, const Bytes& value) {
  GENERAL_NAME* const name = GENERAL_NAME_new();
  ASN1_STRING* const text = ASN1_STRING_type_new(type == GEN_DNS ? V_ASN1_IA5STRING : V_ASN1_OCTET_STRING);
  if (name == nullptr || text == nullptr || sk_GENERAL_NAME_push(names, name) == 0) return false;
  GENERAL_NAME_set0_value(name, type, text);
  return ASN1_STRING_set(text, value.data(), static_cast<int>(value.size())) == 1;
}

Status add_names(X509* certificate, const std::vector<std::string>& texts) {
  const Names names(GENERAL_NAMES_new());
  bool done = names != nullptr;
  for (const std::string& text : texts) {
    const Bytes address = address_bytes(text);
    if (address.empty() && !is_host_name(text))
      return fail(Errc::bad_value, "name: '" + text + "' is neither a host name nor an address",
                  "use the names and numbers by which browsers reach the gateway, without port and brackets");
    done = done && add_name(names.get(), address.empty() ? GEN_DNS : GEN_IPADD, address.empty() ? text : address);
  }
  if (texts.empty()) return fail(Errc::bad_value, "names: none", "name what browsers reach the gateway by");
  if (!done || X509_add1_ext_i2d(certificate, NID_subject_alt_name, names.get(), 0, X509V3_ADD_DEFAULT) != 1)
    return fail(Errc::io_error, "certificate: OpenSSL could not add its names");
  return Done{};
}

bool add_extension(X509* certificate, int kind, const char* value) {
  const Extension extension(X509V3_EXT_conf_nid(nullptr, nullptr, kind, value));
  return extension != nullptr && X509_add_ext(certificate, extension.get(), -1) == 1;
}

bool set_serial(X509* certificate) {
  unsigned char random[kSerialBytes];
  if (RAND_bytes(random, sizeof random) != 1) return false;
  const Number number(BN_bin2bn(random, sizeof random, nullptr));
  return number != nullptr && BN_to_ASN1_INTEGER(number.get(), X509_get_serialNumber(certificate)) != nullptr;
}

bool set_subject(X509* certificate, EVP_PKEY* key) {
  X509_NAME* const subject = X509_get_subject_name(certificate);
  const auto* const text = reinterpret_cast<const unsigned char*>(kCommonName.data());
  return X509_NAME_add_entry_by_NID(subject, NID_commonName, MBSTRING_UTF8, text, static_cast<int>(kCommonName.size()),
                                    -1, 0) == 1 &&
         X509_set_issuer_name(certificate, subject) == 1 && X509_set_pubkey(certificate, key) == 1;
}

bool set_times(X509* certificate, UtcTime now) {
  std::time_t from = static_cast<std::time_t>(now.ns / 1'000'000'000) - kBackdate_s;
  std::time_t until = from + kCertificateDays * kDay_s;
  return ASN1_TIME_set(X509_getm_notBefore(certificate), from) != nullptr &&
         ASN1_TIME_set(X509_getm_notAfter(certificate), until) != nullptr;
}

bool fill(X509* certificate, EVP_PKEY* key, UtcTime now) {
  return X509_set_version(certificate, X509_VERSION_3) == 1 && set_serial(certificate) &&
         set_subject(certificate, key) && set_times(certificate, now) &&
         add_extension(certificate, NID_basic_constraints, "critical,CA:FALSE") &&
         add_extension(certificate, NID_key_usage, "critical,digitalSignature") &&
         add_extension(certificate, NID_ext_key_usage, "serverAuth");
}

std::string text_in(BIO* memory) {
  char* bytes = nullptr;
  const long size = BIO_get_mem_data(memory, &bytes);
  return size > 0 ? std::string(bytes, static_cast<std::size_t>(size)) : std::string();
}

Result<PemPair> to_pem(X509* certificate, EVP_PKEY* key) {
  const Memory crt(BIO_new(BIO_s_mem()));
  const Memory secret(BIO_new(BIO_s_secmem()));
  const bool done = crt != nullptr && secret != nullptr && PEM_write_bio_X509(crt.get(), certificate) == 1 &&
                    PEM_write_bio_PKCS8PrivateKey(secret.get(), key, nullptr, nullptr, 0, nullptr, nullptr) == 1;
  if (!done) return fail(Errc::io_error, "certificate: OpenSSL could not write it");
  return PemPair{text_in(crt.get()), text_in(secret.get())};
}

Memory memory_of(BytesView text) {
  return Memory(BIO_new_mem_buf(text.data(), static_cast<int>(text.size())));
}

Certificate read_certificate(BytesView pem) {
  const Memory memory = memory_of(pem);
  return Certificate(memory ? PEM_read_bio_X509(memory.get(), nullptr, nullptr, nullptr) : nullptr);
}

Key read_key(BytesView pem) {
  const Memory memory = memory_of(pem);
  // The empty passphrase: without it OpenSSL asks at the terminal for an encrypted key's.
  char none[] = "";
  return Key(memory ? PEM_read_bio_PrivateKey(memory.get(), nullptr, nullptr, none) : nullptr);
}

}  // namespace

Result<PemPair> make_self_signed(const std::vector<std::string>& names, UtcTime now) {
  const Key key(EVP_EC_gen("P-256"));
  const Certificate certificate(X509_new());
  if (key == nullptr || certificate == nullptr || !fill(certificate.get(), key.get(), now))
    return fail(Errc::io_error, "certificate: OpenSSL could not make it", "see that OpenSSL 3 is installed whole");
  if (const Status named = add_names(certificate.get(), names); !named) return named.error();
  if (X509_sign(certificate.get(), key.get(), EVP_sha256()) == 0)
    return fail(Errc::io_error, "certificate: OpenSSL could not sign it", "see that OpenSSL 3 is installed whole");
  return to_pem(certificate.get(), key.get());
}

Result<CertificateFacts> facts_of(BytesView certificate) {
  const Certificate read = read_certificate(certificate);
  std::tm ends{};
  if (read == nullptr || ASN1_TIME_to_tm(X509_get0_notAfter(read.get()), &ends) != 1) {
    return fail(Errc::malformed, "no certificate in PEM", "put one there, or remove it and its key to get new ones");
  }
  X509_NAME* const subject = X509_get_subject_name(read.get());
  char name[64] = "";
  X509_NAME_get_text_by_NID(subject, NID_commonName, name, sizeof name);
  const bool is_own = X509_NAME_cmp(subject, X509_get_issuer_name(read.get())) == 0 && name == kCommonName;
  return CertificateFacts{{static_cast<std::int64_t>(::timegm(&ends)) * 1'000'000'000}, is_own};
}

bool is_key_of(BytesView certificate, BytesView key) {
  const Certificate theirs = read_certificate(certificate);
  const Key own = read_key(key);
  return theirs != nullptr && own != nullptr && X509_check_private_key(theirs.get(), own.get()) == 1;
}

bool is_private_key(BytesView key) {
  return read_key(key) != nullptr;
}

bool is_weak_key(BytesView key) {
  constexpr int kBits = 112;
  const Key read = read_key(key);
  return read != nullptr && EVP_PKEY_get_security_bits(read.get()) < kBits;
}

Result<std::string> fingerprint_of(BytesView certificate) {
  const Certificate read = read_certificate(certificate);
  std::string fingerprint = read == nullptr ? std::string() : trb::fingerprint_of(read.get());
  if (!fingerprint.empty()) return fingerprint;
  return fail(Errc::malformed, "no certificate in PEM", "put one there, or remove it and its key to get new ones");
}

}  // namespace trb::gateway
