// When a router says that two computers use the keys of one node, and when it does not.
#include "services/router/core/shared_keys.hpp"

#include <doctest/doctest.h>

#include "services/router/test/test_inbox.hpp"

using namespace trb;
using namespace trb::router;

namespace {

constexpr std::int64_t kSecond = 1'000'000'000;
const Bytes kKey = "key";

MonotonicTime at(std::int64_t seconds) {
  return {seconds * kSecond};
}

/// Of ant, with a node at its inbox that has bee's keys, and says Hello with that boot from that address.
struct Copies : Inbox {
  LinkId next = 100;
  void knock(std::uint64_t boot, const std::string& address) {
    Hello body = hello(bee);
    body.boot = boot;
    body.address = address;
    say(++next, bee.link.public_key, make_message(MessageType::information, "bee", "", body));
  }
  std::string told() {
    for (const LinkErrorRow& row : ant.core->errors().table("ant", fleet.now.mono).errors) {
      if (row.code == kSharedKeys) return row.peer + ": " + row.text;
    }
    return "";
  }
  void keep_alive(std::uint64_t sequence) {
    fleet.arrive(ant, ant.link_to("bee"), sequence, make_message(MessageType::information, "bee", "ant", KeepAlive{0}));
  }
};

}  // namespace

TEST_CASE("an older start that says Hello again while the newer one goes on: two computers, at these addresses") {
  Copies two;
  two.knock(9, "10.0.0.9:45000");
  REQUIRE(two.ant.link_to("bee") != 0);
  two.knock(8, "10.0.0.8:45000");
  CHECK(two.told().empty());
  two.fleet.run(milliseconds(1500));
  two.keep_alive(2);
  two.fleet.run(milliseconds(1000));
  two.knock(8, "10.0.0.8:45000");
  CHECK(two.told() ==
        "bee: two computers use the keys of 'bee' (certificate serial " + std::to_string(two.bee.certificate.serial) +
            "): start 9, which says it is at 10.0.0.9:45000, and start 8, which says it is at 10.0.0.8:45000");
  CHECK(two.ant.count("shared_keys") == 1);
  // The link that comes up may be the thief's: it ends nothing.
  two.knock(10, "10.0.0.8:45000");
  CHECK(two.ant.peer("bee")->boot == 10);
  CHECK_FALSE(two.told().empty());
}

TEST_CASE("new keys of the node end it") {
  Copies two;
  two.knock(9, "10.0.0.9:45000");
  two.knock(8, "10.0.0.8:45000");
  two.fleet.run(milliseconds(1500));
  two.keep_alive(2);
  two.fleet.run(milliseconds(1000));
  two.knock(8, "10.0.0.8:45000");
  REQUIRE_FALSE(two.told().empty());
  two.bee = two.fleet.authority.sign_node("bee");
  two.knock(11, "10.0.0.9:45000");
  REQUIRE(two.ant.peer("bee")->boot == 11);
  CHECK(two.told().empty());
}

TEST_CASE("a copy of state/ put back: the newer start is not heard any more, so nobody says two computers") {
  Copies one;
  one.knock(9, "10.0.0.9:45000");
  for (int i = 0; i < 5; ++i) {
    one.knock(8, "10.0.0.9:45000");
    one.fleet.run(milliseconds(1500));
  }
  CHECK(one.ant.count("refused.conflict") > 2);
  CHECK(one.told().empty());
  one.fleet.run(Seconds(11));
  one.knock(8, "10.0.0.9:45000");
  CHECK(one.ant.peer("bee")->boot == 8);
  CHECK(one.told().empty());
}

TEST_CASE("a node that was started again, and one that got another address, are one computer") {
  Copies one;
  for (std::uint64_t boot = 1; boot < 9; ++boot) {
    one.knock(boot, "10.0.0." + std::to_string(boot % 2) + ":45000");
    one.fleet.run(milliseconds(500));
  }
  one.knock(9, "10.0.0.7:45000");
  one.knock(9, "10.0.0.6:45000");
  one.knock(9, "10.0.0.7:45000");
  CHECK(one.ant.peer("bee")->address == "10.0.0.7:45000");
  CHECK(one.told().empty());
}

TEST_CASE("two copies with one boot number take each other's place: their addresses alternate") {
  Copies two;
  for (int i = 0; i < 6; ++i) {
    CHECK(two.told().empty());
    two.knock(9, i % 2 == 0 ? "10.0.0.9:45000" : "10.0.0.8:45000");
    two.fleet.run(milliseconds(400));
  }
  CHECK(two.told().find("10.0.0.9:45000") != std::string::npos);
  CHECK(two.told().find("10.0.0.8:45000") != std::string::npos);
}

TEST_CASE("an older Hello needs 2 s, a word of the newer start 1 s behind the first, and no pause of a minute") {
  SharedKeys keys;
  CHECK_FALSE(keys.on_older("bee", kKey, 8, at(10), at(10)));
  CHECK_FALSE(keys.on_older("bee", kKey, 8, at(11), {12 * kSecond - 1}));
  CHECK_FALSE(keys.on_older("bee", kKey, 8, {11 * kSecond - 1}, at(13)));
  CHECK(keys.on_older("bee", kKey, 8, at(11), at(13)));
  CHECK_FALSE(keys.on_older("bee", kKey, 7, at(14), at(14)));
  CHECK_FALSE(keys.on_older("bee", kKey, 7, at(75), {74 * kSecond + 1}));
  CHECK_FALSE(keys.is_over("bee", kKey));
  CHECK(keys.is_over("bee", "other"));
  CHECK_FALSE(keys.is_over("bee", "third"));
}

TEST_CASE("addresses that alternate slowly, and link-local ones, are a network's doing") {
  SharedKeys keys;
  const auto alternate = [&](const std::string& a, const std::string& b, std::int64_t seconds, std::int64_t begin) {
    bool told = false;
    for (int i = 0; i < 20; ++i) {
      told =
          keys.on_moved("bee", kKey, {1, i % 2 == 0 ? a : b}, {1, i % 2 == 0 ? b : a}, at(begin + i * seconds)) || told;
    }
    return told;
  };
  CHECK_FALSE(alternate("10.0.0.1:1", "10.0.0.2:1", 6, 0));
  CHECK_FALSE(alternate("10.0.0.1:1", "169.254.0.2:1", 1, 1000));
  CHECK_FALSE(alternate("[fe80::1%eth0]:1", "10.0.0.2:1", 1, 2000));
  CHECK_FALSE(alternate("", "10.0.0.2:1", 1, 3000));
  CHECK(alternate("10.0.0.1:1", "10.0.0.2:1", 1, 4000));
}
