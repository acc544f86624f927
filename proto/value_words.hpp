// A value's kind in the words of a sentence.
#pragma once

#include <string>

#include "proto/value.hpp"

namespace trb {

/// What stands after "is": "a text", "an object", "true", "null".
std::string in_words(const Value& value);

}  // namespace trb
