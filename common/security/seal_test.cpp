// Seals: what a range proves, and every fault that ends it.
#include "common/security/seal.hpp"

#include <doctest/doctest.h>

#include "proto/body.hpp"

using namespace trb;

namespace {

constexpr UtcTime kUtc{1'772'366'400'000'000'000};

/// Both ends of one direction of a link, without the link.
struct Direction {
  SealScope scope{77, 3, 4, true};
  SealWriter writer;
  SealReader reader;

  /// A frame arrives; false: one too many without a seal.
  bool say(const Bytes& frame) {
    writer.add(frame);
    return reader.add(frame);
  }
  SealedRange range() const { return writer.range(scope, kUtc); }
  /// The reader's verdict on a seal that may have been changed on its way.
  SealFault hear(const SealedRange& range) { return reader.close(scope, range, range.last + 1, encode(range)); }
  void seal() {
    const SealedRange sent = range();
    writer.sealed(encode(sent));
    REQUIRE(hear(sent) == SealFault::none);
  }
};

}  // namespace

TEST_CASE("ranges follow each other without a gap, each bound to the one before") {
  init_crypto();
  Direction link;
  link.say("hello");
  link.say("move");
  CHECK(link.range().first == 1);
  CHECK(link.range().last == 2);
  CHECK(link.range().previous.bytes == first_previous());
  link.seal();
  // The seal itself took number 3.
  CHECK(link.writer.next() == 4);
  link.say("stop");
  CHECK(link.range().first == 4);
  CHECK(link.range().last == 4);
  CHECK(link.range().previous.bytes != first_previous());
  link.seal();
  CHECK(link.reader.first() == 6);
}

TEST_CASE("the hash is that of the grammar: the seal before, then size and bytes of each frame") {
  init_crypto();
  SealWriter writer;
  writer.add("ab");
  writer.add("c");
  CHECK(writer.range({}, kUtc).hash.bytes == digest(Bytes(32, '\0') + std::string("\0\0\0\2ab\0\0\0\1c", 11)));
}

TEST_CASE("both directions of an idle link are small: a router has a link to each node of its fleet") {
  CHECK(sizeof(SealWriter) + sizeof(SealReader) <= 160);
}

TEST_CASE("a copy of a running hash is a snapshot: what is added to one is not in the other") {
  init_crypto();
  RangeHash one(first_previous());
  one.add("first");
  const Bytes before = one.value();
  RangeHash copy = one;
  one.add("second");
  CHECK(copy.value() == before);
  CHECK(one.value() != before);
  copy = one;
  CHECK(copy.value() == one.value());
  copy = RangeHash();
  CHECK(copy.is_empty());
}

TEST_CASE("a frame that could not leave is in no seal") {
  init_crypto();
  Direction link;
  link.say("move");
  link.writer.add("refused by the socket");
  link.writer.take_back();
  link.say("stop");
  link.seal();
}

TEST_CASE("a seal that differs in anything is refused") {
  init_crypto();
  Direction link;
  link.say("hello");
  link.seal();
  link.say("move");
  link.say("stop");
  SealedRange range = link.range();
  SUBCASE("another link's") {
    ++range.link;
    CHECK(link.hear(range) == SealFault::wrong_link);
  }
  SUBCASE("another certificate of the sender") {
    ++range.serial;
    CHECK(link.hear(range) == SealFault::wrong_link);
  }
  SUBCASE("made for another receiver") {
    ++range.peer_serial;
    CHECK(link.hear(range) == SealFault::wrong_link);
  }
  SUBCASE("of the other direction") {
    range.dialled = false;
    CHECK(link.hear(range) == SealFault::wrong_link);
  }
  SUBCASE("begins earlier") {
    --range.first;
    CHECK(link.hear(range) == SealFault::wrong_range);
  }
  SUBCASE("ends later") {
    ++range.last;
    CHECK(link.hear(range) == SealFault::wrong_range);
  }
  SUBCASE("leaves a seal out") {
    range.previous.bytes = first_previous();
    CHECK(link.hear(range) == SealFault::wrong_range);
  }
  SUBCASE("of other messages") {
    range.hash.bytes[5] = static_cast<char>(range.hash.bytes[5] ^ 1);
    CHECK(link.hear(range) == SealFault::wrong_hash);
  }
  SUBCASE("nothing changed") {
    CHECK(link.hear(range) == SealFault::none);
    CHECK(link.hear(range) == SealFault::wrong_range);  // but only once
  }
}

TEST_CASE("a frame that was changed on its way is found, whichever it is") {
  init_crypto();
  for (int changed = 0; changed < 3; ++changed) {
    Direction link;
    for (int i = 0; i < 3; ++i) {
      link.writer.add("move " + std::to_string(i));
      REQUIRE(link.reader.add(i == changed ? "move 9" : "move " + std::to_string(i)));
    }
    CHECK(link.hear(link.range()) == SealFault::wrong_hash);
  }
}

TEST_CASE("the 65th message without a seal is one too many") {
  init_crypto();
  Direction link;
  for (std::size_t i = 0; i < kMaxUnsealed; ++i) CHECK(link.say("move"));
  CHECK_FALSE(link.say("move"));
}

TEST_CASE("what came before the last keep-alive must be sealed at the next, however long both took") {
  init_crypto();
  SealReader reader;
  CHECK(reader.add("move"));
  CHECK(reader.add("keep_alive"));
  CHECK(reader.keep_alive(2));  // its seal may still be on its way
  CHECK(reader.add("keep_alive"));
  CHECK_FALSE(reader.keep_alive(3));
}

TEST_CASE("the first word of a link may be a keep-alive, and must be sealed at the next one like any other") {
  init_crypto();
  SealReader reader;
  CHECK(reader.add("keep_alive"));
  CHECK(reader.keep_alive(1));
  CHECK(reader.add("keep_alive"));
  CHECK_FALSE(reader.keep_alive(2));
}

TEST_CASE("keep-alives that are sealed in time are never late") {
  init_crypto();
  Direction link;
  for (int i = 0; i < 3; ++i) {
    const std::uint64_t sequence = link.writer.next();
    REQUIRE(link.say("keep_alive"));
    CHECK(link.reader.keep_alive(sequence));
    link.seal();
  }
}

TEST_CASE("a seal over nothing is none, though all in it is right") {
  init_crypto();
  Direction link;
  CHECK(link.hear(link.range()) == SealFault::wrong_range);
  link.say("move");
  link.seal();
  CHECK(link.hear(link.range()) == SealFault::wrong_range);
}

TEST_CASE("a seal has the number behind the messages that it covers") {
  init_crypto();
  Direction link;
  link.say("move");
  const SealedRange range = link.range();
  CHECK(link.reader.close(link.scope, range, 1, encode(range)) == SealFault::wrong_range);
  CHECK(link.reader.close(link.scope, range, 3, encode(range)) == SealFault::wrong_range);
  CHECK(link.reader.close(link.scope, range, 2, encode(range)) == SealFault::none);
}

TEST_CASE("a seal is the sender's, made with the key that its certificate names") {
  init_crypto();
  const SigningKey key = make_signing_key();
  const Bytes fleet = fleet_id("fleet");
  Certificate signer;
  signer.fleet.bytes = fleet;
  signer.id = "ant";
  signer.identity_key.bytes = key.public_key;
  Direction link;
  link.say("move");
  const SignedRecord seal = sign_seal(link.range(), "ant", fleet, key);
  CHECK(verify_seal(seal, signer));
  CHECK_FALSE(verify_seal(sign_seal(link.range(), "bee", fleet, key), signer));
  CHECK_FALSE(verify_seal(sign_seal(link.range(), "ant", fleet, make_signing_key()), signer));
  CHECK_FALSE(verify_seal(sign_seal(link.range(), "ant", fleet_id("other"), key), signer));
  CHECK_FALSE(verify_seal(sign(kSignedBeacon, "ant", fleet, encode(link.range()), key), signer));
  SignedRecord changed = seal;
  changed.payload.bytes[3] = static_cast<char>(changed.payload.bytes[3] ^ 1);
  CHECK_FALSE(verify_seal(changed, signer));
}
