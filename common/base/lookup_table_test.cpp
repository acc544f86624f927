#include "common/base/lookup_table.hpp"

#include <doctest/doctest.h>

#include <array>
#include <map>
#include <random>
#include <string>
#include <string_view>

namespace trb {

TEST_CASE("it finds what a map has, whatever comes and goes") {
  LookupTable<std::uint64_t, int> table;
  std::map<std::uint64_t, int> rows;
  std::minstd_rand random(11);
  CHECK(table.find(1) == nullptr);
  for (int turn = 0; turn < 5000; ++turn) {
    const std::uint64_t key = random() % 200 * (random() % 2 == 0 ? 1 : 1ULL << 40U);
    if (random() % 3 == 0) {
      table.erase(key);
      rows.erase(key);
    } else {
      table.set(key, rows[key] = turn);
    }
    for (const std::uint64_t other : {key, std::uint64_t{random() % 200}}) {
      const auto at = rows.find(other);
      REQUIRE(table.find(other) == (at == rows.end() ? nullptr : &at->second));
    }
  }
}

TEST_CASE("names are found, and the last row of a name is the one") {
  const std::string ant = "ant", bee = "bee";
  int one = 1, two = 2, three = 3;
  LookupTable<std::string_view, int> table;
  table.set(ant, one);
  table.set(bee, two);
  table.set(ant, three);
  CHECK(table.find("ant") == &three);
  CHECK(table.find("bee") == &two);
  CHECK(table.find("") == nullptr);
  table.erase("ant");
  CHECK(table.find("ant") == nullptr);
  CHECK(table.find("bee") == &two);
}

TEST_CASE("a word is found where it stands in its list, and no other one is") {
  constexpr std::array<std::string_view, 5> kWords{"seal", "hello", "", "goodbye", "keep_alive"};
  constexpr WordIndex<kWords.size()> kIndex(kWords);
  static_assert(kIndex.find("goodbye") == 3);
  for (std::size_t i = 0; i < kWords.size(); ++i) CHECK(kIndex.find(std::string(kWords[i])) == i);
  for (const char* other : {"sea", "seals", "Seal", "goodby"}) CHECK(kIndex.find(other) == kIndex.kNone);
}

}  // namespace trb
