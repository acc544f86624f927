#pragma once

#include <optional>

#include "services/virtual-robots/ur/script.hpp"

namespace trb::virtual_robots::ur {

/** What is known of a value before the program runs. */
struct Shape {
  enum class Kind { any, none, number, boolean, text, list, pose };
  Kind kind = Kind::any;
  std::optional<std::size_t> count;  ///< of a list
  std::optional<double> number;      ///< a literal
};

Shape shape_of(const Value& value);

/** What both may be. */
inline Shape either(const Shape& a, const Shape& b) {
  if (a.kind != b.kind) return {};
  return {a.kind, a.count == b.count ? a.count : std::nullopt, a.number == b.number ? a.number : std::nullopt};
}

}  // namespace trb::virtual_robots::ur
