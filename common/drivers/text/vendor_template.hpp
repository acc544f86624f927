// The vendor's text for a subtype (commands.json) with its placeholders: {data} whole, {0} {1} … items of a list.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "common/base/bytes.hpp"
#include "common/base/result.hpp"
#include "proto/value.hpp"

namespace trb::drivers {

/// Writes a value as one literal of a maker's language. Errors: bad_value, not_escapable.
using Literal = Result<std::string> (*)(const Value&);
Result<std::string> json_literal(const Value& value);

class VendorTemplate {
 public:
  explicit VendorTemplate(std::string_view text);

  /// Every inserted value is a literal of the language, so that no text can end the text around it. Errors: bad_value
  /// (naming what is expected), not_escapable.
  [[nodiscard]] Result<std::string> fill(BytesView data, Literal literal) const;
  /// Values inserted unchanged, on one line. Errors: bad_value, not_escapable.
  [[nodiscard]] Result<std::string> fill_line(BytesView data) const { return fill_plain(data, false); }
  /// Inserted unchanged, for robots whose texts may contain any byte. Errors: bad_value.
  [[nodiscard]] Result<std::string> fill_bytes(BytesView data) const { return fill_plain(data, true); }

  /// How many items of a list it uses: one more than the highest of its {0}, {1} …
  [[nodiscard]] std::size_t items() const;

 private:
  static constexpr int kNone = -2;
  static constexpr int kWhole = -1;
  struct Part {
    std::string literal;
    int hole = kNone;  ///< what follows the literal: an item's number, kWhole or kNone
  };

  [[nodiscard]] Result<std::string> fill_plain(BytesView data, bool any_byte) const;
  std::vector<Part> parts_;
  bool has_holes_ = false;
  bool has_items_ = false;
};

}  // namespace trb::drivers
