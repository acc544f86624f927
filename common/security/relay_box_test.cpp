#include "common/security/relay_box.hpp"

#include <doctest/doctest.h>

using namespace trb;

TEST_CASE("what is locked for a node opens there, and with nobody else's key") {
  init_crypto();
  const LinkKey ant = make_link_key();
  const LinkKey bee = make_link_key();
  const LinkKey relay = make_link_key();
  const Bytes key = relay_key(ant, bee.public_key);
  CHECK(key.size() == 32);
  CHECK(key == relay_key(bee, ant.public_key));
  const Bytes box = lock_relayed(key, "move");
  CHECK(box.size() == 4 + kRelayBoxOverhead);
  CHECK(box.find("move") == Bytes::npos);
  CHECK(lock_relayed(key, "move") != box);
  CHECK(*unlock_relayed(relay_key(bee, ant.public_key), box) == "move");
  CHECK(unlock_relayed(relay_key(relay, ant.public_key), box).error().code == Errc::wrong_key);
  CHECK(unlock_relayed(relay_key(relay, bee.public_key), box).error().code == Errc::wrong_key);
}

TEST_CASE("a box that was changed, cut or never made does not open") {
  init_crypto();
  const LinkKey ant = make_link_key();
  const LinkKey bee = make_link_key();
  const Bytes key = relay_key(ant, bee.public_key);
  const Bytes box = lock_relayed(key, "move");
  for (std::size_t at = 0; at < box.size(); ++at) {
    Bytes changed = box;
    changed[at] = static_cast<char>(changed[at] ^ 1);
    CHECK(unlock_relayed(key, changed).error().code == Errc::wrong_key);
  }
  CHECK(unlock_relayed(key, box.substr(0, kRelayBoxOverhead - 1)).error().code == Errc::malformed);
  CHECK(unlock_relayed(key, "").error().code == Errc::malformed);
  CHECK(unlock_relayed("", box).error().code == Errc::wrong_key);
  CHECK(*unlock_relayed(key, lock_relayed(key, "")) == "");
}

TEST_CASE("a key that is none shares nothing") {
  init_crypto();
  const LinkKey ant = make_link_key();
  CHECK(relay_key(ant, "short").empty());
  CHECK(relay_key(ant, Bytes(32, '\0')).empty());  // the low-order point, which gives every secret the same result
  CHECK(relay_key({}, ant.public_key).empty());
}
