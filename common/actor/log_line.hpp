// A line of the log, as a core wants it written.
#pragma once

#include <cstdint>
#include <string>

namespace trb {

enum class LogLevel : std::uint8_t { debug = 0, info, warning, error };

/// A log line: an event's name in snake_case and the facts.
struct Log {
  LogLevel level{};
  std::string event;
  std::string text;
};

}  // namespace trb
