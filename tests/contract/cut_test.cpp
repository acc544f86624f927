#include <doctest/doctest.h>

#include "proto/body.hpp"
#include "proto/value.hpp"

using namespace trb;

TEST_CASE("a text is cut between characters, and bad bytes are replaced") {
  CHECK(cut_utf8("abc", 10) == "abc");
  CHECK(cut_utf8("a\u00e9b", 2) == "a");
  CHECK(cut_utf8("a\u00e9b", 3) == "a\u00e9");
  CHECK(cut_utf8("\u20ac\u20ac", 5) == "\u20ac");
  CHECK(cut_utf8("a\xff"
                 "b",
                 10) == "a?b");
}

TEST_CASE("a robot's overlong, broken words still reach the other side") {
  const RobotFault fault{"mobile", Severity::critical, std::string(5000, 'x') + "\xff"};
  const auto back = decode<RobotFault>(encode(fault));
  REQUIRE(back);
  CHECK(back->text == std::string(1024, 'x'));
}
