#include "common/scenario/run_id.hpp"

#include <doctest/doctest.h>

using namespace trb;

namespace {

const Bytes kRandom = "1234567";

}  // namespace

TEST_CASE("an id proves whose run it is: nobody else can give a run by it") {
  const std::string id = make_run_id("cloud", kRandom);
  CHECK(id.size() == 32);
  CHECK(id.starts_with("31323334353637"));
  CHECK(check_run_id(id, "cloud").ok());
  for (const char* thief : {"ur3", "clou", "cloud2", ""})
    CHECK(check_run_id(id, thief).error().code == Errc::bad_value);
  CHECK(make_run_id("ur3", kRandom) != id);
  CHECK(make_run_id("cloud", "1234568") != id);
}

TEST_CASE("an id that was changed anywhere but in its mark is nobody's") {
  const std::string id = make_run_id("cloud", kRandom);
  for (std::size_t i = 0; i < 24; ++i) {
    std::string other = id;
    other[i] = other[i] == '0' ? '1' : '0';
    CHECK_FALSE(check_run_id(other, "cloud").ok());
  }
}

TEST_CASE("an earlier version's id is anybody's, and what is no id is refused") {
  CHECK(check_run_id(std::string(32, '7'), "cloud").ok());
  CHECK(check_run_id(std::string(32, '7'), "ur3").ok());
  for (const std::string& wrong : {std::string(), std::string("short"), std::string(33, 'a'), std::string(32, 'A'),
                                   std::string(31, 'a') + "g", std::string(4096, 'a')}) {
    CHECK(check_run_id(wrong, "cloud").error().code == Errc::bad_value);
  }
}
