// A value as a device has written it, and the texts of devices as numbers.
#pragma once

#include <string>
#include <string_view>

#include "common/base/result.hpp"

namespace trb::sensor {

/// A value as it was read, before a rule's scale and offset.
struct Measured {
  bool is_text = false;
  double number = 0;
  std::string text;
};

/// A finite decimal number and nothing else; blanks around it are no part of it. Errors: malformed.
Result<double> parse_finite(std::string_view text);

/// Without the blanks and the ends of lines around it.
std::string_view trim(std::string_view text);
/// At most 255 bytes of UTF-8. Control characters, as STX and ETX around a tag, and blanks around it are no part of it.
std::string plain_text(std::string_view bytes);
/// The beginning of what a device wrote, in quotes, for an error's text.
std::string quoted_bytes(std::string_view bytes);

}  // namespace trb::sensor
