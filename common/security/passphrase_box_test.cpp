#include "common/security/passphrase_box.hpp"

#include <doctest/doctest.h>

#include "common/security/keys.hpp"

using namespace trb;

TEST_CASE("passphrase box: opens by its passphrase alone, and only whole") {
  init_crypto();
  const std::string passphrase = "a hall of robots";
  const auto box = lock_with_passphrase("keys of a node", passphrase);
  REQUIRE(box.ok());
  CHECK(box->find("keys") == Bytes::npos);
  CHECK(*open_with_passphrase(*box, passphrase, "f") == "keys of a node");
  CHECK(open_with_passphrase(*box, "a hall of Robots", "f").error().code == Errc::not_permitted);
  Bytes changed = *box;
  changed.back() = static_cast<char>(changed.back() ^ 1);
  const Error damaged = open_with_passphrase(changed, passphrase, "f").error();
  CHECK(damaged.code == Errc::not_permitted);
  CHECK(damaged.what.find("f: ") == 0);
  CHECK(open_with_passphrase(box->substr(0, 40), passphrase, "f").error().code == Errc::malformed);
}

TEST_CASE("passphrase box: two of the same differ, a short passphrase is refused") {
  init_crypto();
  const std::string passphrase = "a hall of robots";
  CHECK(*lock_with_passphrase("", passphrase) != *lock_with_passphrase("", passphrase));
  CHECK(lock_with_passphrase("", "eleven char").error().code == Errc::bad_value);
}
