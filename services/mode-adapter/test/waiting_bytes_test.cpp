// Bytes that wait for a robot, and how many of those that it has taken are still in memory.
#include "services/mode-adapter/io/waiting_bytes.hpp"

#include <doctest/doctest.h>

#include <algorithm>

using namespace trb;
using namespace trb::adapter;

TEST_CASE("given a robot that is always a little behind, then what it has taken does not stay in memory") {
  constexpr std::size_t kPiece = 1000;
  WaitingBytes waiting;
  waiting.add("ab");
  std::size_t most = 0;
  for (int i = 0; i < 5000; ++i) {
    waiting.add(Bytes(kPiece, static_cast<char>('a' + i % 26)));
    waiting.written(kPiece);
    REQUIRE(waiting.size() == 2);
    most = std::max(most, waiting.kept());
  }
  CHECK(most <= WaitingBytes::kPortion + kPiece + 2);
  CHECK(waiting.rest() == Bytes(2, static_cast<char>('a' + 4999 % 26)));
  waiting.written(2);
  CHECK(waiting.empty());
  CHECK(waiting.kept() == 0);
}

TEST_CASE("given a robot that is far behind, then no more is moved than it has taken, and nothing is lost") {
  WaitingBytes waiting;
  Bytes all;
  for (int i = 0; i < 1 << 18; ++i) all += static_cast<char>(i * 31 + i / 256);
  waiting.add(all);
  Bytes got;
  while (!waiting.empty()) {
    const std::size_t before = waiting.kept();
    const std::size_t part = std::min<std::size_t>(4999, waiting.size());
    got += waiting.rest().substr(0, part);
    waiting.written(part);
    const bool is_moved = waiting.kept() != before && !waiting.empty();
    if (is_moved) CHECK(before - waiting.kept() >= waiting.kept());
    CHECK(waiting.kept() <= waiting.size() + std::max(waiting.size(), WaitingBytes::kPortion));
  }
  CHECK(got == all);
}
