// Foreign text on a person's terminal: control characters are shown, not executed.
#pragma once

#include <string>
#include <string_view>

namespace trb {

/// Replaces each control character (C0 except newline and tab, DEL, and C1 in UTF-8) by \u00XX, which in JSON is the
/// same text.
std::string printable(std::string_view text);

/// Replaces each newline, carriage return and tab in the same way, so that foreign text within a line begins no line,
/// and within a table no column, of its own. Other control characters stay: see printable().
std::string in_one_line(std::string_view text);

}  // namespace trb
