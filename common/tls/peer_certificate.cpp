#include "common/tls/peer_certificate.hpp"

#include <arpa/inet.h>
#include <openssl/bio.h>
#include <openssl/evp.h>
#include <openssl/x509v3.h>

#include <array>
#include <cstdio>
#include <ctime>

#include "common/base/fingerprint.hpp"
#include "common/tls/freed.hpp"

namespace trb {
namespace {

constexpr std::size_t kMostNames = 8;
constexpr std::size_t kMaxText = 80;

/// Everything but printable ASCII is escaped.
std::string text_of(const X509_NAME* name) {
  const std::unique_ptr<BIO, Freed<BIO_free_all>> memory(BIO_new(BIO_s_mem()));
  if (memory == nullptr || X509_NAME_print_ex(memory.get(), name, 0, XN_FLAG_RFC2253) < 0) return {};
  char* bytes = nullptr;
  const long size = BIO_get_mem_data(memory.get(), &bytes);
  return size <= 0 ? std::string() : std::string(bytes, static_cast<std::size_t>(size)).substr(0, kMaxText);
}

std::string day_of(const ASN1_TIME* time) {
  std::tm at{};
  if (ASN1_TIME_to_tm(time, &at) != 1) return "?";
  char text[16];
  return std::strftime(text, sizeof text, "%Y-%m-%d", &at) == 0 ? "?" : text;
}

std::string address_of(const ASN1_OCTET_STRING* bytes) {
  char text[INET6_ADDRSTRLEN] = "";
  const int family = ASN1_STRING_length(bytes) == sizeof(in_addr) ? AF_INET : AF_INET6;
  if (family == AF_INET6 && ASN1_STRING_length(bytes) != sizeof(in6_addr)) return {};
  return ::inet_ntop(family, ASN1_STRING_get0_data(bytes), text, sizeof text) == nullptr ? "" : text;
}

std::string host_of(const ASN1_IA5STRING* text) {
  const auto* const bytes = reinterpret_cast<const char*>(ASN1_STRING_get0_data(text));
  std::string out(bytes, static_cast<std::size_t>(ASN1_STRING_length(text)));
  for (char& c : out) c = c > ' ' && c < '\x7f' ? c : '?';
  return out.substr(0, kMaxText);
}

std::string one_name(const GENERAL_NAME* name) {
  if (name->type == GEN_DNS) return host_of(name->d.dNSName);
  return name->type == GEN_IPADD ? address_of(name->d.iPAddress) : "";
}

std::vector<std::string> names_of(const X509* certificate) {
  using Names = std::unique_ptr<GENERAL_NAMES, Freed<GENERAL_NAMES_free>>;
  const Names names(static_cast<GENERAL_NAMES*>(X509_get_ext_d2i(certificate, NID_subject_alt_name, nullptr, nullptr)));
  std::vector<std::string> out;
  for (int i = 0; names != nullptr && i < sk_GENERAL_NAME_num(names.get()) && out.size() < kMostNames; ++i) {
    std::string name = one_name(sk_GENERAL_NAME_value(names.get(), i));
    if (!name.empty()) out.push_back(std::move(name));
  }
  return out;
}

}  // namespace

std::string fingerprint_of(const X509* certificate) {
  std::array<unsigned char, EVP_MAX_MD_SIZE> digest{};
  unsigned int size = 0;
  if (X509_digest(certificate, EVP_sha256(), digest.data(), &size) != 1) return {};
  return to_fingerprint({reinterpret_cast<const char*>(digest.data()), size});
}

PeerCertificate describe(X509* certificate) {
  return {text_of(X509_get_subject_name(certificate)),
          text_of(X509_get_issuer_name(certificate)),
          names_of(certificate),
          day_of(X509_get0_notBefore(certificate)),
          day_of(X509_get0_notAfter(certificate)),
          fingerprint_of(certificate)};
}

}  // namespace trb
