#include "common/security/passphrase_box.hpp"

#include <doctest/doctest.h>

#include "common/base/hex.hpp"
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

TEST_CASE("passphrase box: what a file of Windows adds to a passphrase is no part of it") {
  init_crypto();
  const std::string typed = "a hall of robots";
  const std::string mark = "\xEF\xBB\xBF";
  for (const std::string& other : {typed + "\r", mark + typed, mark + typed + "\r"}) {
    CHECK(*open_with_passphrase(*lock_with_passphrase("keys", other), typed, "f") == "keys");
    CHECK(*open_with_passphrase(*lock_with_passphrase("keys", typed), other, "f") == "keys");
  }
  CHECK(lock_with_passphrase("", "eleven char\r").error().code == Errc::bad_value);
}

TEST_CASE("passphrase box: one that an earlier version made with a carriage return opens with that file still") {
  init_crypto();
  const Bytes box = *from_hex(
      "82c8ca13979e169216b12bbd143b57102c23b72bf8014729d9da89bc9f191926098a213f5121ef658647475687c4618aa783795df25b0ca7"
      "2b9dcb83");
  CHECK(*open_with_passphrase(box, "a hall of robots\r", "f") == "keys");
  CHECK(open_with_passphrase(box, "a hall of robots", "f").error().code == Errc::not_permitted);
}
