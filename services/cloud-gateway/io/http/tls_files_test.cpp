// The certificate of the first start, which every later one keeps.
#include "services/cloud-gateway/io/http/tls_files.hpp"

#include <doctest/doctest.h>
#include <openssl/pem.h>
#include <openssl/x509v3.h>
#include <sys/stat.h>

#include <cstdio>
#include <memory>

#include "common/base/files.hpp"
#include "common/base/test/temporary_folder.hpp"
#include "services/cloud-gateway/io/http/self_signed.hpp"

using namespace trb;
using namespace trb::gateway;

namespace {

constexpr UtcTime kStart{1'800'000'000'000'000'000};
const std::vector<std::string> kNames{"hall.example", "127.0.0.1", "::1"};

struct GatewayFolder : TemporaryFolder {
  const std::string certificate = path + "/keys/gateway.crt";
  const std::string key = path + "/keys/gateway.key";
  Result<TlsFiles> start() const { return provide_tls_files(path, kNames, kStart); }
  void remove(const std::string& file) const { REQUIRE(std::remove(file.c_str()) == 0); }
};

unsigned mode_of(const std::string& file) {
  struct stat facts {};
  REQUIRE(::stat(file.c_str(), &facts) == 0);
  return facts.st_mode & 0777U;
}

std::shared_ptr<X509> read_x509(const std::string& file) {
  const auto close = [](FILE* opened) { std::fclose(opened); };
  const std::unique_ptr<FILE, decltype(close)> opened(std::fopen(file.c_str(), "r"), close);
  REQUIRE(opened != nullptr);
  return {PEM_read_X509(opened.get(), nullptr, nullptr, nullptr), X509_free};
}

}  // namespace

TEST_CASE("the first start makes both files, the second keeps them") {
  const GatewayFolder folder;
  const auto files = folder.start();
  REQUIRE(files);
  CHECK(files->certificate == folder.certificate);
  CHECK(files->key == folder.key);
  CHECK(mode_of(folder.key) == 0600);
  CHECK(mode_of(folder.path + "/keys") == 0700);
  const auto certificate = read_file(folder.certificate);
  const auto key = read_file(folder.key);
  CHECK(is_key_of(*certificate, *key));
  REQUIRE(folder.start());
  CHECK(*read_file(folder.certificate) == *certificate);
  CHECK(*read_file(folder.key) == *key);
}

TEST_CASE("the certificate is a server's, for its names, for 825 days") {
  const GatewayFolder folder;
  REQUIRE(folder.start());
  const auto certificate = read_x509(folder.certificate);
  REQUIRE(certificate);
  CHECK(X509_get_version(certificate.get()) == X509_VERSION_3);
  CHECK(X509_check_host(certificate.get(), "hall.example", 0, 0, nullptr) == 1);
  CHECK(X509_check_host(certificate.get(), "other.example", 0, 0, nullptr) == 0);
  CHECK(X509_check_ip_asc(certificate.get(), "127.0.0.1", 0) == 1);
  CHECK(X509_check_ip_asc(certificate.get(), "::1", 0) == 1);
  CHECK(X509_check_ip_asc(certificate.get(), "127.0.0.2", 0) == 0);
  CHECK(X509_check_purpose(certificate.get(), X509_PURPOSE_SSL_SERVER, 0) == 1);
  CHECK(X509_check_purpose(certificate.get(), X509_PURPOSE_SSL_CLIENT, 0) == 0);
  CHECK(X509_check_ca(certificate.get()) == 0);
  CHECK(X509_verify(certificate.get(), X509_get0_pubkey(certificate.get())) == 1);
  int days = 0;
  int seconds_more = 0;
  ASN1_TIME_diff(&days, &seconds_more, X509_get0_notBefore(certificate.get()), X509_get0_notAfter(certificate.get()));
  CHECK(days == 825);
  CHECK(seconds_more == 0);
  std::time_t now = kStart.ns / 1'000'000'000;
  CHECK(X509_cmp_time(X509_get0_notBefore(certificate.get()), &now) < 0);
  CHECK(X509_cmp_time(X509_get0_notAfter(certificate.get()), &now) > 0);
}

TEST_CASE("each certificate has a serial number of its own") {
  const GatewayFolder one;
  const GatewayFolder other;
  REQUIRE(one.start());
  REQUIRE(other.start());
  const auto a = read_x509(one.certificate);
  const auto b = read_x509(other.certificate);
  CHECK(ASN1_INTEGER_cmp(X509_get0_serialNumber(a.get()), X509_get0_serialNumber(b.get())) != 0);
}

TEST_CASE("given one of the two files is missing, then the error names it and the cure") {
  for (const bool key_missing : {false, true}) {
    const GatewayFolder folder;
    REQUIRE(folder.start());
    const std::string& gone = key_missing ? folder.key : folder.certificate;
    folder.remove(gone);
    const auto again = folder.start();
    REQUIRE_FALSE(again);
    CHECK(again.error().code == Errc::missing);
    CHECK(again.error().what.starts_with(gone));
    CHECK(again.error().hint.find("remove the ") != std::string::npos);
    CHECK_FALSE(file_exists(gone));
  }
}

TEST_CASE("given the first start was cut off between the two files, then the next one finishes it") {
  const GatewayFolder folder;
  REQUIRE(folder.start());
  REQUIRE(std::rename(folder.key.c_str(), (folder.key + ".staged").c_str()) == 0);
  REQUIRE(folder.start());
  CHECK(is_key_of(*read_file(folder.certificate), *read_file(folder.key)));
  CHECK(mode_of(folder.key) == 0600);
  CHECK_FALSE(file_exists(folder.key + ".staged"));
}

TEST_CASE("given it was cut off before the certificate, then both are made anew") {
  const GatewayFolder folder;
  REQUIRE(folder.start());
  REQUIRE(std::rename(folder.key.c_str(), (folder.key + ".staged").c_str()) == 0);
  folder.remove(folder.certificate);
  REQUIRE(folder.start());
  CHECK(is_key_of(*read_file(folder.certificate), *read_file(folder.key)));
}

TEST_CASE("given a staged key of another certificate, then it is not taken") {
  const GatewayFolder folder;
  REQUIRE(folder.start());
  folder.remove(folder.key);
  REQUIRE(write_file(folder.key + ".staged", make_self_signed(kNames, kStart)->key));
  CHECK_FALSE(folder.start());
}

TEST_CASE("its own certificate is made anew at a start within the last 30 days, another's stays") {
  const GatewayFolder folder;
  REQUIRE(folder.start());
  const auto first = *read_file(folder.certificate);
  const UtcTime ends = folder.start()->ends;
  CHECK(ends == kStart + std::chrono::hours(24 * kCertificateDays) - std::chrono::hours(1));
  REQUIRE(provide_tls_files(folder.path, kNames, ends - kRenewBefore));
  CHECK(*read_file(folder.certificate) == first);
  const auto renewed = provide_tls_files(folder.path, kNames, ends - kRenewBefore + std::chrono::seconds(1));
  REQUIRE(renewed);
  CHECK(*read_file(folder.certificate) != first);
  CHECK(renewed->ends > ends);
  CHECK(is_key_of(*read_file(folder.certificate), *read_file(folder.key)));
}

TEST_CASE("given a renewal was cut off between the two files, then the next start finishes it") {
  const GatewayFolder folder;
  REQUIRE(folder.start());
  const auto made = make_self_signed(kNames, kStart);
  REQUIRE(write_file(folder.key + ".staged", made->key));
  REQUIRE(write_file(folder.certificate, made->certificate));
  REQUIRE(folder.start());
  CHECK(*read_file(folder.certificate) == made->certificate);
  CHECK(is_key_of(*read_file(folder.certificate), *read_file(folder.key)));
}

TEST_CASE("given a certificate that is none, then the start says so") {
  const GatewayFolder folder;
  REQUIRE(folder.start());
  REQUIRE(write_file(folder.certificate, "nothing"));
  CHECK(folder.start().error().code == Errc::malformed);
}

TEST_CASE("given a name that is none, then nothing is made") {
  for (const char* name : {"", "hall example", "[::1]", "hall:8443", "a,DNS:b", "fe80::1%eth0"}) {
    CAPTURE(name);
    const GatewayFolder folder;
    const auto files = provide_tls_files(folder.path, {"ok", name}, kStart);
    REQUIRE_FALSE(files);
    CHECK(files.error().code == Errc::bad_value);
    CHECK_FALSE(file_exists(folder.certificate));
    CHECK_FALSE(file_exists(folder.key));
  }
  CHECK_FALSE(make_self_signed({}, kStart));
}

TEST_CASE("the fingerprint is 32 bytes in pairs of digits; without a certificate there is none") {
  const GatewayFolder folder;
  CHECK(fingerprint(folder.certificate).error().code == Errc::io_error);
  REQUIRE(folder.start());
  const auto text = fingerprint(folder.certificate);
  REQUIRE(text);
  CHECK(text->size() == 32 * 3 - 1);
  CHECK(text->find_first_not_of("0123456789ABCDEF:") == std::string::npos);
  CHECK((*text)[2] == ':');
  CHECK(text->back() != ':');
  CHECK(*fingerprint(folder.certificate) == *text);
  CHECK(fingerprint(folder.key).error().code == Errc::malformed);
}

TEST_CASE("a key of another certificate is told as such") {
  const GatewayFolder folder;
  const GatewayFolder other;
  REQUIRE(folder.start());
  REQUIRE(other.start());
  REQUIRE(write_file(folder.key, *read_file(other.key), 0600));
  const auto files = folder.start();
  REQUIRE_FALSE(files);
  CHECK(files.error().code == Errc::wrong_key);
  CHECK(files.error().what.find("another certificate") != std::string::npos);
  CHECK_FALSE(files.error().hint.empty());
}

TEST_CASE("a key that cannot be read, or is none, is not told as another certificate's: nobody removes good files") {
  const GatewayFolder folder;
  REQUIRE(folder.start());
  REQUIRE(write_file(folder.key, Bytes(100'000, 'x'), 0600));
  CHECK(folder.start().error().code == Errc::too_large);
  REQUIRE(write_file(folder.key, "no key", 0600));
  const auto files = folder.start();
  REQUIRE_FALSE(files);
  CHECK(files.error().code == Errc::malformed);
  CHECK(files.error().hint.find("passphrase") != std::string::npos);
}
