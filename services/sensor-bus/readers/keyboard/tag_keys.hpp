// A reader of tags that types: keys in, a tag at each Enter.
#pragma once

#include <cstdint>
#include <optional>
#include <string>

namespace trb::sensor {

class TagKeys {
 public:
  static constexpr std::size_t kMaxTag = 255;

  /// A key event of the kernel's input layer: its code, and 1 for down, 0 for up, 2 for repeated. The tag, if this was
  /// the Enter behind one. Keys without a character are ignored; a tag that is too long is dropped whole.
  std::optional<std::string> add(std::uint16_t code, std::int32_t value);
  /// Keys were lost, nobody knows which: what is typed is no tag up to the next Enter, and no shift counts as down.
  void lose();
  [[nodiscard]] std::size_t held() const { return tag_.size(); }

 private:
  std::string tag_;
  bool is_void_ = false;     ///< what is typed up to the next Enter is no tag
  std::uint8_t shifts_ = 0;  ///< which of the two is down
};

}  // namespace trb::sensor
