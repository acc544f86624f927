// Changes a member of a JSON object in its text: whatever else the text has stays byte by byte, comments too.
#pragma once

#include <string>
#include <string_view>

#include "proto/value.hpp"

namespace trb {

/// `text` is an object that parse_json() takes. A member that is not there yet becomes the last one.
std::string with_member(std::string_view text, std::string_view key, const Value& value);
std::string without_member(std::string_view text, std::string_view key);

/// JSON for people: what is short stands on one line, anything else has a line for each member.
std::string pretty_json(const Value& value, std::size_t indent = 0);

}  // namespace trb
