// Text of others on a person's terminal: what would command the terminal is shown, not obeyed.
#pragma once

#include <string>
#include <string_view>

namespace trb {

/// Each control character (C0 but for the newline and the tab, DEL, and C1 as UTF-8 has it) as \u00XX, which in JSON
/// is the same text.
std::string printable(std::string_view text);

}  // namespace trb
