// Converts data into KRL and back. KRL text has no escape for its own quote: assignments refuse one, fields write it as
// `\q`.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "common/base/result.hpp"
#include "proto/value.hpp"

namespace trb::drivers {

/// A number, TRUE or FALSE, or a text in quotes. Errors: bad_value (no literal of that kind), not_escapable (a quote, a
/// control character or a byte outside ASCII).
Result<std::string> krl_literal(const Value& value);

/// A field's text in quotes: `\\`, `\n`, `\r`, `\q` for a quote, `\xHH` for any other byte that is not printable ASCII.
std::string krl_field(std::string_view text);

/// Data as fields of at most that many characters between their quotes; an escape is never cut. At least one field.
std::vector<std::string> krl_chunks(std::string_view data, std::size_t most);

/// Undoes krl_field. Text without quotes is taken unchanged; an unknown escape, too.
std::string krl_text(std::string_view field);

/// The content of a variable.
struct KrlValue {
  std::vector<double> numbers;  ///< TRUE is 1; of a structure: of its components, in their order
  std::string json;             ///< a structure is an object; if components were requested: a list of them
};

/// Errors: malformed, missing (a component).
Result<KrlValue> read_krl(std::string_view text, const std::vector<std::string>& components);

/// A number without its fraction, and between -2^53 and 2^53; 0 for anything else.
std::int64_t krl_whole(std::string_view text);

/// True for TRUE, or a number that is not 0.
bool krl_true(std::string_view text);

}  // namespace trb::drivers
