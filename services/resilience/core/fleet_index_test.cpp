#include "services/resilience/core/fleet_index.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <set>

using namespace trb;
using namespace trb::resilience;

namespace {

using Words = std::vector<std::string>;

/// A small generator with the same numbers everywhere (xorshift64*).
class Dice {
 public:
  explicit Dice(std::uint64_t seed) : state_(seed) {}
  std::uint64_t below(std::uint64_t bound) {
    state_ ^= state_ >> 12U;
    state_ ^= state_ << 25U;
    state_ ^= state_ >> 27U;
    return (state_ * 0x2545F4914F6CDD1DULL >> 33U) % bound;
  }

 private:
  std::uint64_t state_;
};

std::vector<std::string> ids(const FleetIndex& index, const Words& words) {
  std::vector<RobotNumber> numbers;
  index.query(words, numbers);
  CHECK(std::ranges::is_sorted(numbers));
  std::vector<std::string> out;
  for (const RobotNumber number : numbers) out.push_back(index.id_of(number));
  return out;
}

}  // namespace

TEST_CASE("robots are found by all of the words, and no longer once one is not true of them any more") {
  FleetIndex index;
  const RobotNumber a = *index.add("a");
  const RobotNumber b = *index.add("b");
  CHECK(*index.add("a") == a);
  index.set_words(a, {"mobile", "grab", "mobile"});
  index.set_words(b, {"mobile"});
  CHECK(ids(index, {"mobile"}) == Words{"a", "b"});
  CHECK(ids(index, {"mobile", "grab"}) == Words{"a"});
  CHECK(ids(index, {"mobile", "fly"}).empty());
  CHECK(ids(index, {}) == Words{"a", "b"});
  CHECK(index.has(a, "grab"));
  index.set_words(a, {"grab"});
  CHECK(ids(index, {"mobile"}) == Words{"b"});
  CHECK_FALSE(index.has(a, "mobile"));
}

TEST_CASE("a word that a robot has twice is one word") {
  FleetIndex index;
  const RobotNumber a = *index.add("a");
  index.set_words(a, {"mobile", "mobile"});
  index.set_words(a, {"mobile"});
  CHECK(ids(index, {"mobile"}) == Words{"a"});
  index.set_words(a, {"grab"});
  CHECK(ids(index, {"mobile"}).empty());
}

TEST_CASE("a robot that is dropped is nowhere, and its number has nothing of it for the next one") {
  FleetIndex index;
  for (const char* id : {"a", "b", "c"}) index.set_words(*index.add(id), {"mobile"});
  index.set_measures(*index.find("a"), {50, 1, 2, 100});
  index.drop("b");
  index.drop("a");
  index.drop("nobody");
  CHECK(ids(index, {"mobile"}) == Words{"c"});
  CHECK(ids(index, {}) == Words{"c"});
  CHECK(index.size() == 1);
  CHECK(*index.add("d") == 0);
  CHECK_FALSE(index.measures(0).charge == 50);
  CHECK(ids(index, {}) == Words{"d", "c"});
  CHECK(ids(index, {"mobile"}) == Words{"c"});
}

TEST_CASE("a word that is true of nobody takes no room: a node may tell ever new ones") {
  FleetIndex index;
  const RobotNumber a = *index.add("a");
  for (int i = 0; i < 1000; ++i) index.set_words(a, {"word" + std::to_string(i), "mobile"});
  CHECK(index.words() == 2);
  CHECK(ids(index, {"word999"}) == Words{"a"});
  CHECK(ids(index, {"word998"}).empty());
}

TEST_CASE("any fleet, any question: the index answers as a look at every robot does") {
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    Dice dice(seed);
    FleetIndex index;
    std::map<std::string, std::set<std::string>> naive;
    const auto word = [&] { return "w" + std::to_string(dice.below(12)); };
    for (int step = 0; step < 600; ++step) {
      const std::string id = "r" + std::to_string(dice.below(300));
      if (dice.below(10) == 0) {
        index.drop(id);
        naive.erase(id);
        continue;
      }
      std::set<std::string> words;
      for (std::uint64_t i = dice.below(10); i > 0; --i) words.insert(word());
      index.set_words(*index.add(id), Words(words.begin(), words.end()));
      naive[id] = words;
    }
    for (int question = 0; question < 50; ++question) {
      Words asked;
      for (std::uint64_t i = dice.below(5); i > 0; --i) asked.push_back(word());
      Words expected;
      for (const auto& [id, words] : naive) {
        if (std::ranges::all_of(asked, [&words = words](const auto& one) { return words.contains(one); })) {
          expected.push_back(id);
        }
      }
      Words found = ids(index, asked);
      std::sort(found.begin(), found.end());
      CAPTURE(seed);
      CHECK(found == expected);
    }
  }
}
