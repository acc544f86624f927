// The vendor's words for a subtype (commands.json) with their placeholders: {data} whole, {0} {1} … items of a list.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "common/base/bytes.hpp"
#include "common/base/result.hpp"
#include "proto/value.hpp"

namespace trb::drivers {

/// `raw`: as `plain`, for robots whose texts may hold any byte.
enum class Language : std::uint8_t { plain, urscript, json, raw, krl, rapid };

class VendorTemplate {
 public:
  explicit VendorTemplate(std::string_view text);

  /// Errors: bad_value (naming what is expected), not_escapable.
  [[nodiscard]] Result<std::string> fill(BytesView data, Language language) const;

  /// How many items of a list it takes: one more than the highest of its {0}, {1} …
  [[nodiscard]] std::size_t items() const;

 private:
  static constexpr int kNone = -2;
  static constexpr int kWhole = -1;
  struct Part {
    std::string literal;
    int hole = kNone;  ///< what follows the literal: an item's number, kWhole or kNone
  };

  [[nodiscard]] Result<std::string> fill_plain(BytesView data, bool any_byte) const;
  /// Every filling is a literal of the language, so that no text can end what stands around it.
  using Literal = Result<std::string> (*)(const Value&);
  [[nodiscard]] Result<std::string> fill_literals(BytesView data, Literal literal) const;

  std::vector<Part> parts_;
  bool has_holes_ = false;
  bool has_items_ = false;
};

}  // namespace trb::drivers
