// Messages without a last part: told from messages that only wait for the loop, or are under way.
#include "common/transport/incomplete_bytes.hpp"

#include <doctest/doctest.h>

using namespace trb;

namespace {

constexpr std::uint64_t kHandshake = 867;
constexpr std::uint64_t kMebibyte = 1U << 20U;

}  // namespace

TEST_CASE("a connection whose messages have all been received is never suspected, however much it has sent") {
  IncompleteBytes bytes;
  std::uint64_t read = kHandshake;
  for (int i = 0; i < 10'000; ++i) {
    for (const std::uint64_t size :
         {std::uint64_t{0}, std::uint64_t{48}, std::uint64_t{222}, std::uint64_t{223}, kMebibyte + 1024}) {
      bytes.add(size);
      read += on_wire(size);
    }
  }
  CHECK_FALSE(bytes.look(read));
  CHECK_FALSE(bytes.on_empty());
}

TEST_CASE("a message under way, and one that is being decrypted, are usual") {
  IncompleteBytes bytes;
  CHECK_FALSE(bytes.look(kHandshake + 2 * on_wire(kMebibyte) + 8192));
  CHECK_FALSE(bytes.look(kMostIncomplete));
  CHECK(bytes.look(kMostIncomplete + 1));
}

TEST_CASE("a loop that is behind finds the connection good once it has received what was complete") {
  IncompleteBytes bytes;
  CHECK(bytes.look(kHandshake + 200 * on_wire(kMebibyte)));
  for (int i = 0; i < 200; ++i) bytes.add(kMebibyte);
  CHECK_FALSE(bytes.on_empty());
  CHECK_FALSE(bytes.on_empty());
}

TEST_CASE("what is read after the look does not count: it may be complete, and wait") {
  IncompleteBytes bytes;
  CHECK(bytes.look(4 * kMebibyte));
  CHECK(bytes.look(400 * kMebibyte));
  bytes.add(2 * kMebibyte);
  CHECK_FALSE(bytes.on_empty());
  CHECK(bytes.look(400 * kMebibyte));
}

TEST_CASE("parts without end are found, whatever complete messages came before them") {
  IncompleteBytes bytes;
  bytes.add(50 * kMebibyte);
  const std::uint64_t before = kHandshake + on_wire(50 * kMebibyte);
  CHECK_FALSE(bytes.look(before + 2 * kMebibyte));
  CHECK(bytes.look(before + 4 * kMebibyte));
  CHECK(bytes.on_empty());
}

TEST_CASE("parts that were received together, and dropped, count like messages") {
  IncompleteBytes bytes;
  CHECK(bytes.look(5 * on_wire(kMebibyte)));
  bytes.add_on_wire(5 * on_wire(kMebibyte));
  CHECK_FALSE(bytes.on_empty());
}

TEST_CASE("a bound of its own") {
  IncompleteBytes bytes(kMostUnproven);
  CHECK_FALSE(bytes.look(kMostUnproven));
  CHECK(bytes.look(kMostUnproven + 1));
}
