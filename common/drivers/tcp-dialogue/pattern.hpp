// What an answer looks like: literal text, * for anything, {0} {1} … for what a value takes from it.
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "common/base/result.hpp"

namespace trb::drivers {

class Pattern {
 public:
  static constexpr std::size_t kMost = 256;
  static constexpr std::size_t kMostHoles = 16;

  /// Errors: bad_value (empty, too long, two wildcards with nothing between them, a hole twice or left out).
  static Result<Pattern> read(std::string_view text);

  [[nodiscard]] const std::string& text() const { return text_; }
  [[nodiscard]] std::size_t holes() const { return holes_; }
  /// False: it is wildcards only, and matches every line.
  [[nodiscard]] bool has_literal() const;

  /// What each hole takes, the shortest text that fits, by its number; nothing if the line does not match. Takes time
  /// in proportion to the line.
  [[nodiscard]] std::optional<std::vector<std::string_view>> take(std::string_view line) const;
  [[nodiscard]] bool matches(std::string_view line) const { return take(line).has_value(); }

 private:
  static constexpr int kAny = -1;
  struct Wildcard {
    int hole = kAny;
    std::string literal;  ///< what follows it
  };
  [[nodiscard]] Status check() const;

  std::string text_;
  std::string first_;  ///< the literal before the first wildcard
  std::vector<Wildcard> wildcards_;
  std::size_t holes_ = 0;
};

}  // namespace trb::drivers
