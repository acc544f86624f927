// A service's log: one line an event, "TIME LEVEL SERVICE EVENT facts"; 10 MB a file, three files.
#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <string_view>

#include "common/base/time.hpp"

namespace trb {

enum class Level : std::uint8_t { debug = 0, info, warning, error };

/// Logs to `path` (and warnings to standard error as well); if the path is empty or cannot be written to, only to
/// standard error.
void open_log(const std::string& service, const std::string& path);

/// `event` is a name in snake_case; `text` the facts. Control characters in it are replaced: one event stays one line.
void log_event(Level level, std::string_view event, std::string_view text);

/// Lets at most `burst` lines of one event through in a window; the next window reports how many were held back.
class RateLimit {
 public:
  explicit RateLimit(unsigned burst = 5, Duration window = std::chrono::seconds(10)) : burst_(burst), window_(window) {}
  /// True if the line may be written; `held_back` is set when a new window begins.
  bool allow(std::string_view event, MonotonicTime now, std::uint64_t& held_back);

 private:
  struct State {
    MonotonicTime start;
    std::uint64_t count = 0;
  };
  unsigned burst_;
  Duration window_;
  std::map<std::string, State, std::less<>> events_;
};

/// log_event behind a RateLimit: for what a stranger or a broken robot can cause.
void log_limited(RateLimit& limit, MonotonicTime now, Level level, std::string_view event, std::string_view text);

}  // namespace trb
