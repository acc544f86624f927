#include "proto/value_words.hpp"

namespace trb {

std::string in_words(const Value& value) {
  if (value.is_bool()) return value.boolean() ? "true" : "false";
  const std::string kind(value.kind());
  return kind == "null" ? kind : (value.is_object() ? "an " : "a ") + kind;
}

}  // namespace trb
