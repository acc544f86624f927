// The text of a RAPID socket server: "CODE PARAMETER ... #" is answered "CODE OK VALUE ...".
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "common/base/bytes.hpp"
#include "common/base/result.hpp"
#include "common/base/time.hpp"
#include "proto/value.hpp"

namespace trb::drivers {

struct RapidAnswer {
  int code = 0;
  bool ok = false;
  std::vector<double> numbers;  ///< of the values, up to the first that is not a number
  std::string text;             ///< all of the values, unescaped
};

/// Errors: malformed.
Result<RapidAnswer> read_rapid_answer(std::string_view line);

/// A parameter: a number of six digits (what RAPID's numbers hold), true as 1, a text with `%HH` for a blank, `#`, `%`,
/// a quote, a control character and any byte outside ASCII; an empty text is `%`. A list: its items. Errors: bad_value.
Result<std::string> rapid_literal(const Value& value);
std::string rapid_unescaped(std::string_view text);

/// Answers end with `#` or a line end. From a server that has sent neither, a moment's silence ends one.
class RapidReader {
 public:
  static constexpr std::size_t kMost = 4096;

  void add(BytesView bytes, MonotonicTime now);
  /// The next answer's text.
  std::optional<std::string> next(MonotonicTime now);
  [[nodiscard]] bool overflowed() const { return buffer_.size() > kMost; }
  [[nodiscard]] std::optional<MonotonicTime> next_deadline() const;
  /// For a new connection.
  void clear() {
    buffer_.clear();
    ends_ = false;
  }

 private:
  Bytes buffer_;
  MonotonicTime heard_;
  bool ends_ = false;  ///< the server has ended an answer itself
};

}  // namespace trb::drivers
