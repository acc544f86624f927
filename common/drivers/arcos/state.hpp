// The content of a Pioneer's standard server information packet (SIP), sent ten times a second.
#pragma once

#include <cstdint>
#include <optional>

#include "common/drivers/arcos/packet.hpp"

namespace trb::drivers {

constexpr std::uint8_t kArcosStopped = 0x32;  ///< a SIP's type while the robot stands, and
constexpr std::uint8_t kArcosMoving = 0x33;

/// A SIP as received, without its sonar readings. Older robots end it after those.
struct ArcosSip {
  bool moving = false;
  std::uint16_t x = 0;  ///< mm; the lower 15 bits count, and wrap
  std::uint16_t y = 0;
  double heading = 0;  ///< degrees, over -180 and up to 180, counter-clockwise
  int left = 0;        ///< mm/s
  int right = 0;
  double rotation = 0;  ///< degrees/s
  double battery = 0;   ///< V
  std::uint16_t stall = 0;
  std::uint16_t flags = 0;
  int compass = 0;  ///< degrees
  std::uint8_t digital_in = 0;
  std::uint8_t digital_out = 0;

  [[nodiscard]] bool motors() const { return (flags & 1U) != 0; }
  [[nodiscard]] bool emergency_stop() const { return (flags & (1U << 5U)) != 0; }
  [[nodiscard]] bool stalled() const { return (stall & 0x0101U) != 0; }
  [[nodiscard]] bool bumped() const { return (stall & 0xfefeU) != 0; }
  [[nodiscard]] bool is_still() const;
};

/// Empty if the packet is not a SIP, or is incomplete.
std::optional<ArcosSip> read_arcos_sip(const ArcosPacket& packet);

/// The robot's own position. The packets' counters of 15 bits wrap after 32 m, so the distance since the last packet is
/// added up. One that is met for the first time is within 16 m of its origin: more cannot be told of it.
class ArcosOdometry {
 public:
  void update(const ArcosSip& sip);
  /// A connection begins: the robot may have been switched on again since.
  void begin_again() { known_ = false; }
  /// On this connection the robot began at its origin, this far (mm) from where it was at the end of the last one.
  [[nodiscard]] double jump() const { return jump_; }
  /// SETO was sent: the robot's next position near 0, 0 is the new one.
  void expect_origin() { origin_comes_ = true; }

  [[nodiscard]] double x() const { return x_; }  ///< mm
  [[nodiscard]] double y() const { return y_; }

 private:
  void set(const ArcosSip& sip);

  double x_ = 0;
  double y_ = 0;
  double jump_ = 0;
  std::uint16_t last_x_ = 0;
  std::uint16_t last_y_ = 0;
  bool known_ = false;
  bool origin_comes_ = false;
};

}  // namespace trb::drivers
