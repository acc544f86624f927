#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <string_view>
#include <vector>

#include "services/virtual-robots/support/options.hpp"
#include "services/virtual-robots/support/socket.hpp"

namespace trb::virtual_robots {

/** The program of a virtual robot. */
struct RobotProgram {
  std::string name;             ///< "trb-virtual-ur"
  std::string what;             ///< its description, for --help
  std::vector<Option> options;  ///< its own; --die-with-parent is added
  /** Runs until `end` is readable. Throws OptionError if the options do not fit together. */
  std::function<void(const Fd& end)> run;
};

/** Returns the exit status: 0, or 2 after a line on stderr, or 1 if the parent has already ended. */
int robot_main(int argc, char** argv, RobotProgram program);

// Options that most robots have.
Option address_option(std::string& address, const std::string& preset = "127.0.2.2");
Option speed_option(double& speed);

/** A port, or 0 for `auto`. */
std::uint16_t port_of(std::string_view text, std::uint16_t highest = 65535);

}  // namespace trb::virtual_robots
