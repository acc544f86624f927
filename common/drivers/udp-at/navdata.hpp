// Reads an AR.Drone 2's navdata (UDP 5554): little-endian, header 0x55667788, options, checksum.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "common/base/bytes.hpp"
#include "common/base/result.hpp"
#include "proto/bodies/robot.hpp"

namespace trb::drivers {

// Bits of the drone's state that the driver uses.
constexpr std::uint32_t kArFlying = 1U << 0;
constexpr std::uint32_t kArCommandHeard = 1U << 6;  ///< a CONFIG was taken; to be acknowledged
constexpr std::uint32_t kArBootstrap = 1U << 11;    ///< the drone waits for the selection of its navdata
constexpr std::uint32_t kArBatteryLow = 1U << 15;
constexpr std::uint32_t kArComWatchdog = 1U << 30;
constexpr std::uint32_t kArEmergency = 1U << 31;

/// The drone's control state, with its own numbers.
enum class ArControl : std::uint8_t {
  none = 0,
  init,
  landed,
  flying,
  hovering,
  test,
  taking_off,
  going,
  landing,
  looping
};
constexpr auto enum_names(ArControl) {
  return std::array<std::string_view, 10>{"none", "init",       "landed", "flying",  "hovering",
                                          "test", "taking_off", "going",  "landing", "looping"};
}

/// The option "demo", in SI units and the axes of REP-103 (x forward, y left, z up).
struct ArDemo {
  ArControl control{};
  int battery = 0;      ///< percent
  double altitude = 0;  ///< metres
  double roll = 0, pitch = 0, yaw = 0;
  double vx = 0, vy = 0, vz = 0;  ///< m/s
};

struct ArNavdata {
  std::uint32_t state = 0;
  std::uint32_t sequence = 0;
  std::optional<ArDemo> demo;

  [[nodiscard]] bool has(std::uint32_t bits) const { return (state & bits) != 0; }
  [[nodiscard]] ArControl control() const { return demo ? demo->control : ArControl::none; }
  /// Hovers or flies; take-off over, landing not begun.
  [[nodiscard]] bool airborne() const;
  /// On the ground, neither taking off nor landing.
  [[nodiscard]] bool landed() const;
};

/// One datagram. Errors: malformed (not navdata), bad_signature (its checksum is wrong).
Result<ArNavdata> read_ar_navdata(BytesView datagram);

/// A state bit that is a fault when it is set.
struct ArFault {
  std::uint32_t bit = 0;
  std::string_view name;  ///< its name in commands.json
  Severity severity{};
  std::string_view text;
};
const std::vector<ArFault>& ar_faults();

/// The drone's problems, for a person: "cutout, battery low"; the emergency itself is not named. May be empty.
std::string ar_problems(std::uint32_t state);

}  // namespace trb::drivers
