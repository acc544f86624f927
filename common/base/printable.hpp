// Foreign text on a person's terminal: control characters are shown, not executed.
#pragma once

#include <string>
#include <string_view>

namespace trb {

/// Replaces each control character (C0 except newline and tab, DEL, and C1 in UTF-8) by \u00XX, which in JSON is the
/// same text.
std::string printable(std::string_view text);

}  // namespace trb
