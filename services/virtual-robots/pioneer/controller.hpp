#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "services/virtual-robots/pioneer/drive.hpp"
#include "services/virtual-robots/pioneer/flash_settings.hpp"
#include "services/virtual-robots/pioneer/packet.hpp"

namespace trb::virtual_robots::pioneer {

/** The faults of the robot; each ends its motion. */
enum class Fault : std::uint8_t { none, stall, motors_off, stop_button };

struct Start {
  std::string name = "Pioneer";
  Position place;       ///< in the hall, metres and radians: the odometry's origin
  double charge = 100;  ///< percent
};

/**
 * The microcontroller of a Pioneer 3: synchronisation, commands, packets, and the wheels that it drives. Its state
 * does not depend on TCP, as behind a real robot's serial-to-network bridge: a client that vanishes leaves it open.
 * `wall` is real time in seconds, which the watchdog uses; the robot's own time may run faster.
 */
class Controller {
 public:
  static constexpr double kSipPeriod = 0.1;
  static constexpr double kWatchdog = 2.0;

  explicit Controller(const Start& start);

  /** Takes a client's bytes; returns the answers. */
  std::string take(std::string_view bytes, double wall);
  /** Lets the robot's time pass. */
  void advance(double robot_seconds, double wall);

  /** A standard packet; empty while the robot is not open. */
  std::string sip();

  void set_fault(Fault fault, const std::string& text);
  void set_charge(double percent) { charge_ = percent; }

  bool open() const { return open_; }
  /** In the hall: metres, radians. */
  Position place() const;
  std::vector<std::string> take_lines();

 private:
  std::string on_sync(const Command& command);
  std::string on_command(const Command& command);
  bool on_motion(const Command& command);
  void on_limit(const Command& command);
  void close();
  std::string config() const;
  void tell(std::string line) { lines_.push_back(std::move(line)); }
  void tell_place();
  double voltage() const;
  int stall_bits() const;
  int flag_bits() const;

  Start start_;
  Drive drive_;
  FlashSettings flash_;
  Position turned_;  ///< where in the hall the odometry's origin is: metres, radians
  CommandReader reader_;
  int synced_ = 0;  ///< SYNCs answered; 3: connected
  bool open_ = false;
  bool motors_ = false;
  bool sonar_ = true;
  int digital_out_ = 0;
  Fault fault_ = Fault::none;
  double charge_;
  double heard_ = 0;  ///< when the last command came
  bool watchdog_ = false;
  bool moving_ = false;
  int disc_ = 0;  ///< the next sonar disc
  std::vector<std::string> lines_;
};

}  // namespace trb::virtual_robots::pioneer
