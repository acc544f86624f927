// Two clocks that cannot be mixed up: monotonic for deadlines and leases, UTC for what people and certificates read.
#pragma once

#include <chrono>
#include <compare>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

namespace trb {

using Duration = std::chrono::nanoseconds;

/// A point of this machine's monotonic clock (since boot); never sent to another machine.
struct MonotonicTime {
  std::int64_t ns = 0;
  auto operator<=>(const MonotonicTime&) const = default;
  MonotonicTime operator+(Duration d) const { return {ns + d.count()}; }
  MonotonicTime operator-(Duration d) const { return {ns - d.count()}; }
  Duration operator-(MonotonicTime other) const { return Duration{ns - other.ns}; }
};

/// UTC in nanoseconds since 1970; the form of every time on the wire.
struct UtcTime {
  std::int64_t ns = 0;
  auto operator<=>(const UtcTime&) const = default;
  UtcTime operator+(Duration d) const { return {ns + d.count()}; }
  UtcTime operator-(Duration d) const { return {ns - d.count()}; }
};

/// The moment of a call to a core: both clocks, read once by the shell.
struct Now {
  MonotonicTime mono;
  UtcTime utc;
};

/// ISO 8601 with milliseconds, "2026-03-01T12:00:00.250Z".
std::string to_iso8601(UtcTime time);
/// The inverse, of years 1970 to 2200: with no fraction, or one of 1 to 9 digits. Nothing else.
std::optional<UtcTime> from_iso8601(std::string_view text);

/// The earlier of two optional deadlines.
inline std::optional<MonotonicTime> earlier(std::optional<MonotonicTime> a, std::optional<MonotonicTime> b) {
  if (!a) return b;
  if (!b) return a;
  return *a < *b ? a : b;
}

inline Duration seconds(double s) {
  return Duration{static_cast<std::int64_t>(s * 1e9)};
}
inline double to_seconds(Duration d) {
  return static_cast<double>(d.count()) * 1e-9;
}

}  // namespace trb
