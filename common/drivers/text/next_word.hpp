#pragma once

#include <string_view>

namespace trb::drivers {

/// The next word, removed from the text together with the blanks around it.
std::string_view next_word(std::string_view& text);

}  // namespace trb::drivers
