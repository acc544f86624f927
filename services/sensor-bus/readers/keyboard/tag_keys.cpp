#include "services/sensor-bus/readers/keyboard/tag_keys.hpp"

#include <linux/input-event-codes.h>

#include <string_view>
#include <utility>

namespace trb::sensor {
namespace {

struct Row {
  std::uint16_t first;
  std::string_view plain;
  std::string_view shifted;
};
/// The US layout, in which such readers type.
constexpr Row kRows[] = {{KEY_1, "1234567890-=", "!@#$%^&*()_+"},     {KEY_Q, "qwertyuiop[]", "QWERTYUIOP{}"},
                         {KEY_A, "asdfghjkl;'`", "ASDFGHJKL:\"~"},    {KEY_BACKSLASH, "\\zxcvbnm,./", "|ZXCVBNM<>?"},
                         {KEY_KP7, "789-456+1230.", "789-456+1230."}, {KEY_SPACE, " ", " "}};

char character(std::uint16_t code, bool shifted) {
  for (const Row& row : kRows) {
    const std::string_view keys = shifted ? row.shifted : row.plain;
    if (code >= row.first && code < row.first + keys.size()) return keys[code - row.first];
  }
  return '\0';
}

}  // namespace

std::optional<std::string> TagKeys::add(std::uint16_t code, std::int32_t value) {
  if (code == KEY_LEFTSHIFT || code == KEY_RIGHTSHIFT) {
    const std::uint8_t bit = code == KEY_LEFTSHIFT ? 1 : 2;
    shifts_ = static_cast<std::uint8_t>(value == 0 ? shifts_ & ~bit : shifts_ | bit);
    return std::nullopt;
  }
  if (value != 1) return std::nullopt;
  if (code == KEY_ENTER || code == KEY_KPENTER) {
    std::string tag = std::exchange(tag_, {});
    const bool dropped = std::exchange(is_void_, false);
    if (tag.empty() || dropped) return std::nullopt;
    return tag;
  }
  const char typed = character(code, shifts_ != 0);
  if (typed == '\0' || is_void_) return std::nullopt;
  if (tag_.size() < kMaxTag) {
    tag_ += typed;
  } else {
    is_void_ = true;
    tag_.clear();
  }
  return std::nullopt;
}

void TagKeys::lose() {
  tag_.clear();
  is_void_ = true;
  shifts_ = 0;
}

}  // namespace trb::sensor
