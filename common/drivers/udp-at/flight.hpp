// What is sent to an AR.Drone again and again (REF, PCMD), and the command that it carries out.
#pragma once

#include <optional>
#include <string>

#include "common/drivers/driver.hpp"
#include "common/drivers/udp-at/at_text.hpp"
#include "common/drivers/udp-at/navdata.hpp"

namespace trb::drivers {

/// One command at a time; a new one takes the place of the last.
///
/// command           | its end                                  | it has failed
/// ------------------|------------------------------------------|----------------------------------------------
/// take_off          | the drone stands in the air              | emergency; still on the ground after 3 s
/// land              | the drone stands on the ground           | -
/// hover, move (for) | the time has passed: it hovers           | emergency; the drone lands or has landed
/// emergency         | the drone tells that its motors are cut  | not told after 1.5 s
/// recover           | the drone tells that it is over          | not told after 1.5 s
///
/// What the drone does by itself (a low battery, its watchdog) is followed: it is never told to take off again.
class AtFlight {
 public:
  /// Adopts the drone's present state: it stays in the air or on the ground.
  void follow(const ArNavdata& drone);

  void begin(Token token, const std::string& subtype, const AtOrder& order, Now now, const DriverOut& out);
  /// It hovers; with `land`, or if it is not yet or no longer in the air, it lands.
  void stop(const ArNavdata& drone, bool land);
  /// The link is lost: it is unknown what becomes of the command.
  void lose(const std::string& reason, const DriverOut& out);

  void on_navdata(const ArNavdata& drone, Now now, const DriverOut& out);
  void tick(Now now, const DriverOut& out);
  [[nodiscard]] bool runs(Token token) const { return task_ && task_->token == token; }

  // The arguments of REF and PCMD, without the sequence number.
  [[nodiscard]] std::string reference() const;
  [[nodiscard]] std::string motion() const { return motion_.empty() ? "0,0,0,0,0" : "1," + motion_; }

 private:
  struct Task {
    Token token = 0;
    std::string subtype;
    AtAction action{};
    MonotonicTime began;
    std::optional<MonotonicTime> until;
  };

  void check_emergency(const ArNavdata& drone, Now now, const DriverOut& out);
  void check_ground(const ArNavdata& drone, Now now, const DriverOut& out);
  void end_well(const DriverOut& out);
  void end_badly(Errc code, const std::string& what, const std::string& hint, const DriverOut& out);
  [[nodiscard]] bool does(AtAction action) const { return task_ && task_->action == action; }
  [[nodiscard]] bool toggles() const { return does(AtAction::emergency) || does(AtAction::recover); }

  bool fly_ = false;
  std::string motion_;  ///< roll, pitch, gaz, yaw; empty: it hovers
  std::optional<Task> task_;
};

/// True if it neither drifts nor climbs, or is landing.
bool at_is_still(const ArNavdata& drone);

}  // namespace trb::drivers
