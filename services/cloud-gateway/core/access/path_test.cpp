// Valid and hostile paths.
#include "services/cloud-gateway/core/access/path.hpp"

#include <doctest/doctest.h>

using namespace trb;
using namespace trb::gateway;

TEST_CASE("a path is its segments, decoded once; its query is not looked at") {
  CHECK(*split_path("/api/v1/robots") == std::vector<std::string>{"api", "v1", "robots"});
  CHECK(*split_path("/a/run%2D7?x=%00/../") == std::vector<std::string>{"a", "run-7"});
  CHECK(*split_path("/a/%7e%7E") == std::vector<std::string>{"a", "~~"});
  CHECK(split_path("/")->empty());
  CHECK(split_path("/?x=1")->empty());
  CHECK(*split_path("/...") == std::vector<std::string>{"..."});
}

TEST_CASE("hostile paths are refused") {
  for (const char* path : {"",
                           "api",
                           "http://host/api",
                           "*",
                           "//",
                           "/a//b",
                           "/a/",
                           "/.",
                           "/..",
                           "/a/../b",
                           "/a/./b",
                           "/%2e%2e/b",
                           "/.%2E/b",
                           "/a%2fb",
                           "/a%2Fb",
                           "/a%5cb",
                           "/a\\b",
                           "/a%00b",
                           "/a%0d%0aSet-Cookie:x",
                           "/a\r\n",
                           "/%252e%252e",
                           "/a%",
                           "/a%2",
                           "/a%zz",
                           "/a%+1",
                           "/a b",
                           "/a%20b",
                           "/%c3%a4",
                           "/\xc3\xa4",
                           "/%c0%ae%c0%ae",
                           "/<script>",
                           "/a\"b",
                           "/a;b",
                           "/a#b",
                           "/a'b",
                           "/%7f"}) {
    CAPTURE(path);
    CHECK(split_path(path).error().code == Errc::malformed);
  }
  CHECK_FALSE(split_path(std::string_view("/a\0b", 4)));
}

TEST_CASE("overlong paths are refused: as a whole, by their segments, by a segment") {
  CHECK(split_path("/" + std::string(kMaxSegment, 'a')));
  CHECK(split_path("/" + std::string(kMaxSegment + 1, 'a')).error().code == Errc::too_large);
  CHECK(split_path("/1/2/3/4/5/6/7/8"));
  CHECK(split_path("/1/2/3/4/5/6/7/8/9").error().code == Errc::too_large);
  CHECK(split_path("/a?" + std::string(kMaxTarget, 'a')).error().code == Errc::too_large);
}

TEST_CASE("given every byte in every place of an escape, then what comes out may stand in a path") {
  for (int first = 0; first < 256; ++first) {
    for (int second = 0; second < 256; ++second) {
      const auto path = split_path(std::string("/%") + static_cast<char>(first) + static_cast<char>(second));
      if (!path) continue;
      for (const char c : path->front()) CHECK((c > ' ' && c < '\x7f' && c != '/' && c != '%'));
    }
  }
}
