// The connection to an ARCOS robot: synchronised, opened, kept alive, and given up when the robot falls silent.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "common/drivers/arcos/packet.hpp"
#include "common/drivers/driver.hpp"

namespace trb::drivers {

/// After so long without a packet of the robot's the connection is given up.
constexpr Duration kArcosSilence = std::chrono::seconds(3);

/// stage | heard                      | then
/// ------|----------------------------|--------------------------------------------------------------------
/// sync  | the echo of SYNC0, SYNC1   | the next SYNC
/// sync  | SYNC2 with the robot's name | OPEN, STOP, ENABLE 1: open
/// sync  | a SIP                      | CLOSE (an earlier client's connection was left open), SYNC0 after 0.3 s
/// sync  | anything else, or nothing  | SYNC0 again after 1 s; given up after the fourth
/// open  | a SIP                      | the robot is there
/// open  | no SIP for 3 s             | given up
///
/// PULSE is sent when nothing else was for a second: a robot that receives nothing for 2 s stops by itself.
class ArcosLink {
 public:
  enum class Stage : std::uint8_t { down, sync, open };

  [[nodiscard]] Stage stage() const { return stage_; }

  void begin(Now now, const DriverOut& out);
  void end() { stage_ = Stage::down; }
  void send(Bytes packets, Now now, const DriverOut& out);

  /// The robot's packets once it is open; valid until the next call.
  const std::vector<ArcosPacket>& receive(BytesView bytes, Now now, const DriverOut& out);
  /// Why the connection is given up, if it is.
  std::optional<std::string> tick(Now now, const DriverOut& out);
  [[nodiscard]] std::optional<MonotonicTime> next_deadline() const;

 private:
  void on_sync(const ArcosPacket& packet, Now now, const DriverOut& out);
  void open(const ArcosPacket& answer, Now now, const DriverOut& out);
  void sync_from_start(Now now, const DriverOut& out);

  Stage stage_ = Stage::down;
  std::uint8_t expected_ = 0;  ///< the SYNC whose echo is waited for
  bool closing_ = false;       ///< an earlier connection was sent CLOSE
  int attempts_ = 0;           ///< how often SYNC0 was sent
  MonotonicTime due_;          ///< sync: of the next attempt
  MonotonicTime last_sent_;
  MonotonicTime last_sip_;  ///< or the opening
  ArcosReader reader_;
  std::vector<ArcosPacket> packets_;
};

}  // namespace trb::drivers
