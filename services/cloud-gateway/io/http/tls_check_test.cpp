// What trb check says of the page's certificate and key.
#include "services/cloud-gateway/io/http/tls_check.hpp"

#include <doctest/doctest.h>
#include <openssl/pem.h>
#include <openssl/rsa.h>
#include <sys/stat.h>

#include <filesystem>

#include "common/base/files.hpp"
#include "common/base/test/temporary_folder.hpp"
#include "services/cloud-gateway/io/http/self_signed.hpp"
#include "services/cloud-gateway/io/http/tls_files.hpp"

using namespace trb;
using namespace trb::gateway;

namespace {

constexpr UtcTime kMade{1'800'000'000'000'000'000};
const std::vector<std::string> kLocal{"localhost"};

struct CheckedFolder : TemporaryFolder {
  const std::string certificate = path + "/keys/gateway.crt";
  const std::string key = path + "/keys/gateway.key";
  CheckedFolder() { REQUIRE(provide_tls_files(path, kLocal, kMade)); }
  ConfigFaults faults(UtcTime now = kMade) const { return check_tls_files(path, now); }
  /// The only fault is of that file, says this, and has a cure.
  void check_only(const std::string& file, const std::string& what) const {
    const ConfigFaults found = faults();
    REQUIRE(found.size() == 1);
    CHECK(found[0].file == file);
    CAPTURE(found[0].what);
    CHECK(found[0].what.find(what) != std::string::npos);
    CHECK_FALSE(found[0].hint.empty());
  }
};

std::string text_of(BIO* memory) {
  char* bytes = nullptr;
  const long size = BIO_get_mem_data(memory, &bytes);
  std::string out(bytes, static_cast<std::size_t>(size));
  BIO_free(memory);
  return out;
}

std::string rsa_key(unsigned bits, const EVP_CIPHER* cipher = nullptr) {
  EVP_PKEY* const key = EVP_RSA_gen(bits);
  BIO* const memory = BIO_new(BIO_s_mem());
  char word[] = "secret";
  PEM_write_bio_PrivateKey(memory, key, cipher, nullptr, 0, nullptr, cipher == nullptr ? nullptr : word);
  EVP_PKEY_free(key);
  return text_of(memory);
}

}  // namespace

TEST_CASE("the gateway's files: what it has made itself, and nothing at all, are good; a check writes nothing") {
  const CheckedFolder folder;
  CHECK(folder.faults().empty());
  std::filesystem::remove(folder.certificate);
  std::filesystem::remove(folder.key);
  CHECK(folder.faults().empty());
  CHECK_FALSE(file_exists(folder.certificate));
}

TEST_CASE("the gateway's files: one of the two is missing, unless a start that was cut off left its key") {
  const CheckedFolder folder;
  REQUIRE(std::rename(folder.key.c_str(), (folder.key + ".staged").c_str()) == 0);
  CHECK(folder.faults().empty());
  std::filesystem::remove(folder.key + ".staged");
  folder.check_only("keys/gateway.key", "no such file");
  const CheckedFolder other;
  std::filesystem::remove(other.certificate);
  other.check_only("keys/gateway.crt", "no such file");
}

TEST_CASE("the gateway's files: a key of another certificate, with a passphrase, too weak, for others to read") {
  const CheckedFolder folder;
  REQUIRE(write_file(folder.key, rsa_key(2048)));
  folder.check_only("keys/gateway.key", "is not the key of keys/gateway.crt");
  REQUIRE(write_file(folder.key, rsa_key(2048, EVP_aes_128_cbc())));
  folder.check_only("keys/gateway.key", "without a passphrase");
  REQUIRE(write_file(folder.key, ""));
  folder.check_only("keys/gateway.key", "no private key");
  REQUIRE(write_file(folder.key, rsa_key(1024)));
  CHECK(folder.faults().at(0).what.find("too weak") != std::string::npos);
  const CheckedFolder open;
  REQUIRE(::chmod(open.key.c_str(), 0644) == 0);
  open.check_only("keys/gateway.key", "others may read");
  CHECK(open.faults()[0].hint.find("chmod 600 " + open.key) != std::string::npos);
}

TEST_CASE("the gateway's files: what is no certificate, a folder, a pipe") {
  const CheckedFolder folder;
  REQUIRE(write_file(folder.certificate, "nothing"));
  folder.check_only("keys/gateway.crt", "no certificate in PEM");
  std::filesystem::remove(folder.certificate);
  std::filesystem::create_directory(folder.certificate);
  folder.check_only("keys/gateway.crt", "cannot read");
  std::filesystem::remove(folder.certificate);
  REQUIRE(::mkfifo(folder.certificate.c_str(), 0600) == 0);
  folder.check_only("keys/gateway.crt", "is a pipe");
}

TEST_CASE("the gateway's files: a certificate that has ended; one of its own is made anew at a start") {
  const CheckedFolder folder;
  const UtcTime ends = facts_of(*read_file(folder.certificate))->ends;
  CHECK(folder.faults(ends - std::chrono::seconds(1)).empty());
  const ConfigFaults found = folder.faults(ends);
  REQUIRE(found.size() == 1);
  CHECK(found[0].what == "ended " + to_iso8601(ends) + ": no browser takes it");
  CHECK(found[0].hint == "restart the node: it makes a new one");
}
