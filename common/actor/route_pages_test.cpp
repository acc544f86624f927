#include <doctest/doctest.h>

#include "common/actor/route_pages.hpp"

using namespace trb;

namespace {

RouteTable page(const std::string& after, const std::vector<std::string>& ids, bool more) {
  RouteTable out;
  out.node = "ant";
  for (const std::string& id : ids) out.routes.emplace_back().id = id;
  out.more = more;
  out.after = after;
  return out;
}

}  // namespace

TEST_CASE("a table of one page is whole at once") {
  RoutePages pages;
  const auto taken = pages.take(page("", {"ant", "bee"}, false));
  REQUIRE(taken.whole);
  CHECK(taken.whole->node == "ant");
  CHECK(taken.whole->routes.size() == 2);
  CHECK_FALSE(taken.next);
}

TEST_CASE("pages are asked for one after the other, and put together") {
  RoutePages pages;
  auto taken = pages.take(page("", {"zed", "ant"}, true));
  REQUIRE(taken.next);
  CHECK_FALSE(taken.whole);
  CHECK(taken.next->after == "ant");
  taken = pages.take(page("ant", {"bee"}, true));
  REQUIRE(taken.next);
  CHECK(taken.next->after == "bee");
  taken = pages.take(page("bee", {"cat"}, false));
  REQUIRE(taken.whole);
  REQUIRE(taken.whole->routes.size() == 4);
  CHECK(taken.whole->routes[3].id == "cat");
}

TEST_CASE("asked anew, the first page begins again and a page of the older asking is none") {
  RoutePages pages;
  pages.take(page("", {"ant"}, true));
  pages.take(page("ant", {"bee"}, true));
  CHECK(pages.take(page("", {"ant"}, true)).next->after == "ant");
  const auto late = pages.take(page("bee", {"cat"}, false));
  CHECK_FALSE(late.whole);
  CHECK_FALSE(late.next);
  CHECK(pages.take(page("ant", {"bee", "cat"}, false)).whole->routes.size() == 3);
  CHECK_FALSE(pages.take(page("cat", {"dog"}, false)).whole);
}

TEST_CASE("a router that promises more and brings nothing new does not keep anybody asking") {
  RoutePages pages;
  CHECK(pages.take(page("", {}, true)).whole);
  pages.take(page("", {"ant"}, true));
  CHECK(pages.take(page("ant", {"ant"}, true)).whole);
}
