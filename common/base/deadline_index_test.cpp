#include "common/base/deadline_index.hpp"

#include <doctest/doctest.h>

#include <map>
#include <random>
#include <string>

namespace trb {
namespace {

constexpr MonotonicTime at(std::int64_t ns) {
  return {ns};
}

}  // namespace

TEST_CASE("the earliest of many is known, and who is due") {
  DeadlineIndex<std::string> index;
  std::map<std::string, DeadlineIndex<std::string>::Slot> slots;
  const auto set = [&](const std::string& who, std::optional<MonotonicTime> due) { index.set(who, slots[who], due); };
  CHECK_FALSE(index.earliest());
  set("ant", at(30));
  set("bee", at(10));
  set("cat", at(10));
  CHECK(index.earliest() == at(10));
  CHECK(index.due(at(9)).empty());
  CHECK(index.due(at(10)) == std::vector<std::string>{"bee", "cat"});
  set("bee", at(40));
  CHECK(slots["bee"] == at(40));
  set("cat", std::nullopt);
  set("cat", std::nullopt);
  CHECK(index.due(at(100)) == std::vector<std::string>{"ant", "bee"});
  CHECK(index.earliest() == at(30));
}

TEST_CASE("it says what a walk over all rows says, whatever is set") {
  DeadlineIndex<int> index;
  std::map<int, DeadlineIndex<int>::Slot> slots;
  std::minstd_rand random(7);
  for (int turn = 0; turn < 2000; ++turn) {
    const int who = static_cast<int>(random() % 20);
    const auto due = random() % 4 == 0 ? std::nullopt : std::optional(at(static_cast<std::int64_t>(random() % 50)));
    index.set(who, slots[who], due);
    std::optional<MonotonicTime> walked;
    for (const auto& [key, slot] : slots) walked = earlier(walked, slot);
    REQUIRE(slots[who] == due);
    REQUIRE(index.earliest() == walked);
  }
}

}  // namespace trb
