#pragma once

#include <string_view>

#include "common/base/result.hpp"

namespace trb {

constexpr std::size_t kMaxIdSize = 64;

/// The id of a node, a task or a place: a lower-case letter, then letters, digits, '_' or '-', 64 at most.
bool is_valid_id(std::string_view id);

/// A subtype or a skill: the same alphabet, upper case allowed (the paper prints `goTo`).
bool is_valid_word(std::string_view word);

/// The same as is_valid_id, as a Status that names the field.
Status check_id(std::string_view field, std::string_view id);

}  // namespace trb
