#pragma once

#include <initializer_list>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace trb::virtual_robots {

/** A finite decimal number that is the whole text; else nothing. Independent of the locale. */
std::optional<double> parse_number(std::string_view text);

/** A decimal integer that is the whole text. */
std::optional<long long> parse_integer(std::string_view text);

std::string format_fixed(double value, int decimals);

/** The text on one line of UTF-8: \\, \n, \r, \t and \xHH replace what would break or garble it. */
std::string escape_line(std::string_view text);

/** Undoes escape_line for \\, \n, \r and \t; any other backslash stays as it is. */
std::string unescape_line(std::string_view text);

/** The parts between the separators; an empty text is one empty part. */
std::vector<std::string> split(std::string_view text, char separator);

/** Removes the first word from the text, with the space after it. */
std::string_view take_word(std::string_view& text);

std::string_view trim(std::string_view text);

/** The answer to the line `where`: where the robot is now. */
std::string where_line(std::initializer_list<double> numbers);

}  // namespace trb::virtual_robots
