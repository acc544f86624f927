#include "services/virtual-robots/support/robot_main.hpp"

#include <unistd.h>

#include <cerrno>
#include <cstdio>
#include <exception>
#include <system_error>

#include "services/virtual-robots/support/process.hpp"

namespace trb::virtual_robots {
namespace {

int complain(const RobotProgram& program, const char* why) {
  std::fprintf(stderr, "%s: %s\n", program.name.c_str(), why);
  return 2;
}

}  // namespace

int robot_main(int argc, char** argv, RobotProgram program) {
  const int parent = ::getppid();
  bool dies = false;
  program.options.push_back(
      {"--die-with-parent", "", "end when the starting process ends", [&dies](auto) { dies = true; }});
  try {
    if (!parse_options({argv + 1, argv + argc}, program.options)) {
      std::fputs(describe_options(program.name, program.what, program.options).c_str(), stdout);
      return 0;
    }
    const Fd end = catch_end_signals();
    if (dies && !die_with_parent(parent)) return 1;
    program.run(end);
    return 0;
  } catch (const std::system_error& error) {
    if (error.code().value() == EACCES) {
      complain(program, "a port below 1024 needs root; use --port, and \"port\" in commands.json");
    }
    return complain(program, error.what());
  } catch (const std::exception& error) {
    return complain(program, error.what());
  }
}

Option address_option(std::string& address, const std::string& preset) {
  return {"--address", "ADDRESS", "where to listen (" + preset + ")", [&address](auto text) { address = text; }};
}

Option speed_option(double& speed) {
  return {"--speed", "N", "robot time runs N times faster (1)",
          [&speed](auto text) { speed = number_option(text, 0.001, 100000); }};
}

std::uint16_t port_of(std::string_view text, std::uint16_t highest) {
  return text == "auto" ? std::uint16_t{0} : static_cast<std::uint16_t>(number_option(text, 1, highest));
}

}  // namespace trb::virtual_robots
