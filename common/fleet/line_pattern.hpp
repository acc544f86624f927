// A regular expression that finds one value in a line of a sensor.
#pragma once

#include <optional>
#include <regex>
#include <string>
#include <string_view>

#include "common/base/result.hpp"

namespace trb {

/// Bounded, so that no line, however hostile, makes it slow or deep: polynomial time, no backtracking.
class LinePattern {
 public:
  /// ECMAScript without back references; one group at most. Errors: bad_value, with a hint.
  static Result<LinePattern> make(const std::string& text);

  /// What the group matches, or, without a group, the whole pattern.
  [[nodiscard]] std::optional<std::string_view> find(std::string_view line) const;

 private:
  explicit LinePattern(std::regex regex) : regex_(std::move(regex)) {}
  std::regex regex_;
};

}  // namespace trb
