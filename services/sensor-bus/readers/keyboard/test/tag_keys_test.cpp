#include "services/sensor-bus/readers/keyboard/tag_keys.hpp"

#include <doctest/doctest.h>
#include <linux/input-event-codes.h>

using namespace trb;
using namespace trb::sensor;

TEST_CASE("keys become a tag at Enter") {
  TagKeys keys;
  const auto press = [&](std::uint16_t code) {
    const auto tag = keys.add(code, 1);
    keys.add(code, 0);
    return tag;
  };
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
