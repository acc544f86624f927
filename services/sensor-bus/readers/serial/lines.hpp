// The lines of a serial port, and what a rule finds in them.
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <utility>

#include "common/fleet/sensor_rule.hpp"
#include "services/sensor-bus/readers/measured.hpp"

namespace trb::sensor {

/// What a channel of a line protocol finds in a line; nothing: the line does not speak of it. Errors: malformed.
Result<std::optional<Measured>> parse_line(const SensorRule& rule, const SensorChannel& channel, std::string_view line);

/// Bytes of a serial line cut into lines. One that is longer than kMaxLine is dropped, up to its end.
class LineReader {
 public:
  static constexpr std::size_t kMaxLine = 1024;

  /// Each whole line without its end; empty ones are left out.
  template <class F>
  void add(std::string_view bytes, F on_line) {
    for (const char c : bytes) {
      if (c != '\n' && c != '\r') {
        put(c);
        continue;
      }
      if (!too_long_ && !line_.empty()) on_line(std::string_view(line_));
      line_.clear();
      too_long_ = false;
    }
  }
  /// True once after a line that was too long.
  bool take_too_long() { return std::exchange(untold_, false); }
  [[nodiscard]] std::size_t held() const { return line_.size(); }

 private:
  void put(char c) {
    if (too_long_) return;
    if (line_.size() < kMaxLine) {
      line_ += c;
    } else {
      too_long_ = untold_ = true;
      line_.clear();
    }
  }

  std::string line_;
  bool too_long_ = false;
  bool untold_ = false;
};

}  // namespace trb::sensor
