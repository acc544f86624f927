#include "common/base/gives_way.hpp"

#include <doctest/doctest.h>

#include <vector>

using namespace trb;

namespace {

struct Place {
  std::string owner;
};

std::string asks(const std::vector<Place>& places, const std::string& asking) {
  return gives_way(places, asking, &Place::owner);
}

}  // namespace

TEST_CASE("who has the most gives way to who asks; who would have as many itself gets nothing") {
  CHECK(asks({{"a"}, {"a"}, {"a"}}, "b") == "a");
  CHECK(asks({{"a"}, {"a"}, {"b"}}, "b") == "b");
  CHECK(asks({{"a"}, {"a"}, {"b"}}, "a") == "a");
  CHECK(asks({{"a"}, {"b"}, {"b"}, {"b"}}, "c") == "b");
  // Each has one: nobody takes another's only place.
  CHECK(asks({{"a"}, {"b"}}, "c") == "c");
  CHECK(asks({}, "a") == "a");
}
