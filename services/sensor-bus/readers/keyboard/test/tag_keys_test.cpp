#include "services/sensor-bus/readers/keyboard/tag_keys.hpp"

#include <doctest/doctest.h>
#include <linux/input-event-codes.h>

#include <optional>
#include <string>

using namespace trb;
using namespace trb::sensor;

namespace {

/// The key goes down and up again; the tag, if it was Enter.
std::optional<std::string> press_on(TagKeys& keys, std::uint16_t code) {
  const auto tag = keys.add(code, 1);
  keys.add(code, 0);
  return tag;
}

}  // namespace

TEST_CASE("keys become a tag at Enter") {
  TagKeys keys;
  const auto press = [&](std::uint16_t code) { return press_on(keys, code); };
  for (const int code : {KEY_0, KEY_4, KEY_F}) CHECK_FALSE(press(static_cast<std::uint16_t>(code)).has_value());
  keys.add(KEY_LEFTSHIFT, 1);
  press(KEY_A);
  keys.add(KEY_A, 2);  // repeated: the same key
  keys.add(KEY_LEFTSHIFT, 0);
  press(KEY_F5);
  press(KEY_KP1);
  CHECK(press(KEY_ENTER) == "04fA1");
  CHECK_FALSE(press(KEY_ENTER).has_value());
  for (std::size_t i = 0; i < 2 * TagKeys::kMaxTag; ++i) press(KEY_1);
  CHECK(keys.held() <= TagKeys::kMaxTag);
  CHECK_FALSE(press(KEY_ENTER).has_value());
  press(KEY_7);
  CHECK(press(KEY_KPENTER) == "7");
}

TEST_CASE("of keys that were lost no tag is made") {
  TagKeys keys;
  const auto press = [&](std::uint16_t code) { return press_on(keys, code); };
  SUBCASE("the tag under way is void until its Enter, the next one is whole") {
    press(KEY_4);
    keys.lose();
    CHECK(keys.held() == 0);
    press(KEY_2);
    CHECK_FALSE(press(KEY_ENTER).has_value());
    press(KEY_A);
    CHECK(press(KEY_ENTER) == "a");
  }
  SUBCASE("a lost release of shift shifts no later tag") {
    keys.add(KEY_LEFTSHIFT, 1);
    keys.add(KEY_RIGHTSHIFT, 1);
    keys.lose();
    press(KEY_ENTER);
    press(KEY_A);
    CHECK(press(KEY_ENTER) == "a");
  }
}
