#pragma once

#include <string>
#include <string_view>

namespace trb::virtual_robots::kuka {

/** A field's text: `\\`, `\n`, `\r`, `\q` for a quote and `\xHH` stand for what a KRL text cannot hold. */
std::string escape_field(std::string_view text);
std::string unescape_field(std::string_view text);

/** How many characters of an escaped text fit into `most` without cutting an escape. */
std::size_t whole_escapes(std::string_view escaped, std::size_t most);

}  // namespace trb::virtual_robots::kuka
