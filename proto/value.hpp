// A JSON document as plain values: for configuration files and messages' data, without a JSON library in any header.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <utility>
#include <variant>
#include <vector>

#include "common/base/result.hpp"

namespace trb {

struct Value {
  using List = std::vector<Value>;
  using Object = std::vector<std::pair<std::string, Value>>;  ///< in the document's order
  std::variant<std::nullptr_t, bool, std::int64_t, double, std::string, List, Object> is;

  bool operator==(const Value& other) const;

  [[nodiscard]] bool is_object() const { return std::holds_alternative<Object>(is); }
  [[nodiscard]] bool is_list() const { return std::holds_alternative<List>(is); }
  [[nodiscard]] bool is_text() const { return std::holds_alternative<std::string>(is); }
  [[nodiscard]] bool is_integer() const { return std::holds_alternative<std::int64_t>(is); }
  [[nodiscard]] bool is_number() const { return is_integer() || std::holds_alternative<double>(is); }
  [[nodiscard]] bool is_bool() const { return std::holds_alternative<bool>(is); }
  [[nodiscard]] bool is_null() const { return std::holds_alternative<std::nullptr_t>(is); }

  /// Unchecked: call is_…() first.
  [[nodiscard]] const Object& object() const { return std::get<Object>(is); }
  [[nodiscard]] const List& list() const { return std::get<List>(is); }
  [[nodiscard]] const std::string& text() const { return std::get<std::string>(is); }
  [[nodiscard]] std::int64_t integer() const { return std::get<std::int64_t>(is); }
  [[nodiscard]] bool boolean() const { return std::get<bool>(is); }
  [[nodiscard]] double number() const;

  /// The member with that key; nullptr if there is none or if this is not an object.
  [[nodiscard]] const Value* find(std::string_view key) const;

  /// "text", "number", "list" … for error messages.
  [[nodiscard]] std::string_view kind() const;
};

// Completes the cycle of Value, Object and its pairs here: clang cannot do so when it first meets a bare Object.
static_assert(noexcept(Value{}));

struct ParseLimits {
  std::size_t bytes = 1U << 20U;
  std::size_t depth = 32;
  std::size_t values = 100'000;
};

/// Parses JSON text. Keys named `_comment` may repeat and are dropped (Appendix A); any other repeated key is
/// `duplicate`. Errors: malformed (with line and column), too_large, duplicate.
Result<Value> parse_json(std::string_view text, const ParseLimits& limits = {});

/// Compact JSON; bytes that are not UTF-8 are replaced. A key may occur once in an object.
std::string dump_json(const Value& value);

/// True for well-formed UTF-8 without surrogates or overlong forms.
bool is_utf8(std::string_view text);

/// The beginning of a text, at most that many bytes, without cutting a character; bytes that are not UTF-8 become '?'.
std::string cut_utf8(std::string_view text, std::size_t most);

}  // namespace trb
