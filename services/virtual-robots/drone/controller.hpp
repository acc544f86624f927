#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "services/virtual-robots/drone/commands.hpp"
#include "services/virtual-robots/drone/navdata.hpp"

namespace trb::virtual_robots::drone {

/**
 * The drone's program: takes AT commands, flies, watches its link. `now` is in seconds of real time; the aircraft's
 * time runs `speed` times faster, the watchdog's does not.
 */
class Controller {
 public:
  // Without a command for so long ...
  static constexpr double kWatchdog_s = 0.05;  ///< ... it sets comWatchdog; only COMWDG clears it
  static constexpr double kHolds_s = 0.25;     ///< ... a client is not merely late: it hovers, and obeys after COMWDG
  static constexpr double kLost_s = 2;         ///< ... communication is lost: it tells its client nothing any more
  static constexpr double kLandsAfter_s = 4;   ///< ... it lands

  Controller(double speed, double now) : speed_(speed), begin_(now), last_advance_(now), last_command_(now) {}

  void take(std::string_view datagram, double now);
  /** A client wants navdata; a new client gets no flight data until it configures that. */
  void wake(bool other_client);
  /** Not after communication was lost, until a client wakes it again. */
  bool tells() const { return tells_; }
  void advance(double now);

  // Events outside of the protocol.
  void fail_emergency();
  void raise(std::uint32_t bit) { injected_ |= bit; }
  void clear_faults();
  void set_battery(double percent) { aircraft_.set_battery(percent); }

  /** The next navdata; its number increases with each call. */
  std::string navdata();
  const Aircraft& aircraft() const { return aircraft_; }
  std::vector<std::string> take_events();

 private:
  void take_command(const Command& command, double now);
  bool is_new(const Command& command);
  void take_reference(const Command& command);
  void take_motion(const Command& command);
  void take_config(const Command& command);
  void end_watchdog();
  void take_other(const Command& command);
  void reject(const Command& command) { events_.push_back("rejected " + command.name); }
  void toggle_emergency();
  void watch(double now);
  void tell_phase();
  std::uint32_t state() const;

  double speed_;
  double begin_;
  double last_advance_;
  double last_command_;
  Aircraft aircraft_;
  Phase told_phase_ = Phase::landed;
  std::uint32_t last_sequence_ = 0;
  std::uint32_t navdata_sequence_ = 0;
  std::uint32_t injected_ = 0;
  bool refused_take_off_ = false;
  NavdataWish wish_;
  bool command_taken_ = false;
  bool emergency_ = false;
  bool emergency_bit_ = false;  ///< of the last REF
  bool has_client_ = false;     ///< a command has come since its start: before, nobody is missed
  bool tells_ = false;
  bool watchdog_ = false;
  bool holds_ = false;
  bool lost_ = false;
  std::vector<std::string> events_;
};

}  // namespace trb::virtual_robots::drone
