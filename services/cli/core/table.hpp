#pragma once

#include <string>
#include <vector>

namespace trb::cli {

/// Rows of text in aligned columns, two spaces apart; the first row is the heading. Empty without rows. A cell's
/// newlines and tabs are shown: it forges no row.
std::string format_table(std::vector<std::vector<std::string>> rows);

/// What an empty cell shows: "-".
std::string or_dash(const std::string& text);

/// The words with `between` between them; "-" without any.
std::string joined(const std::vector<std::string>& words, const char* between);

/// Terminal columns that UTF-8 text takes (one a code point).
std::size_t width_of(const std::string& text);

}  // namespace trb::cli
