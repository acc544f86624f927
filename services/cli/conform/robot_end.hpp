// The node's end of the robot's connection, for one who waits: listens, takes the robot in, reads and writes with
// deadlines.
#pragma once

#include <cstdint>
#include <string>

#include "common/base/result.hpp"
#include "common/base/time.hpp"

namespace trb::cli::conform {

class RobotEnd {
 public:
  RobotEnd() = default;
  RobotEnd(const RobotEnd&) = delete;
  RobotEnd& operator=(const RobotEnd&) = delete;
  ~RobotEnd();

  /// Errors: bad_value (no IPv4 address), io_error (the port is taken …).
  Status listen(const std::string& address, std::uint16_t port);
  [[nodiscard]] std::uint16_t port() const;

  /// Waits for a robot from that address (empty: any); others are sent away. False if none came in time.
  bool accept(const std::string& from, Duration patience);
  [[nodiscard]] bool connected() const { return robot_ >= 0; }
  void drop();

  /// What has come, appended; waits at most so long. False if the robot has closed.
  bool read(std::string& into, Duration patience);
  /// All of it. What comes meanwhile is appended to `heard`, so that two who write do not wait for each other. False if
  /// the robot has closed, or takes nothing for so long.
  bool write(const std::string& bytes, std::string& heard, Duration patience);

 private:
  int listener_ = -1;
  int robot_ = -1;
};

/// Lets that time pass.
void pause(Duration duration);

}  // namespace trb::cli::conform
