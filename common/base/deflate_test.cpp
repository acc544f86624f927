#include "common/base/deflate.hpp"

#include <doctest/doctest.h>

using namespace trb;

TEST_CASE("what is deflated comes back, and regular bytes become few") {
  Bytes text;
  for (int i = 0; i < 2000; ++i) text += "task-" + std::to_string(i) + " robot-" + std::to_string(i % 50) + ";";
  for (const Bytes& one : {Bytes(), Bytes("x"), Bytes(100'000, '\0'), text}) {
    const Bytes small = deflated(one);
    const auto back = inflated(small, one.size());
    REQUIRE(back);
    CHECK((*back == one));
  }
  CHECK(deflated(text).size() * 4 < text.size());
}

TEST_CASE("few bytes that would become many are refused, and no more than allowed is written") {
  const Bytes bomb = deflated(Bytes(50'000'000, 'a'));  // NOLINT(bugprone-string-constructor): it is to be large
  CHECK(bomb.size() < 100'000);
  CHECK(inflated(bomb, 1'000'000).error().code == Errc::too_large);
  CHECK(inflated(deflated(Bytes(101, 'a')), 100).error().code == Errc::too_large);
  CHECK(inflated(deflated(Bytes(100, 'a')), 100));
}

TEST_CASE("cut, changed and longer bytes are refused") {
  const Bytes good = deflated("a run and its tasks, a run and its tasks");
  for (std::size_t size = 0; size < good.size(); ++size) {
    CHECK(inflated(good.substr(0, size), 1000).error().code == Errc::malformed);
  }
  CHECK(inflated(good + "x", 1000).error().code == Errc::malformed);
  Bytes changed = good;
  changed.back() = static_cast<char>(changed.back() ^ 1);
  CHECK(inflated(changed, 1000).error().code == Errc::malformed);
  CHECK(inflated("no zlib at all", 1000).error().code == Errc::malformed);
}
