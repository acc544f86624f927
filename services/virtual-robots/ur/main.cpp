#include <unistd.h>

#include <cstdio>
#include <exception>

#include "services/virtual-robots/support/options.hpp"
#include "services/virtual-robots/ur/virtual_ur.hpp"

namespace {

using namespace trb::virtual_robots;

/** What the command line asks for. */
struct Request {
  ur::Settings settings;
  bool die_with_parent = false;
};

std::optional<std::uint16_t> port_base(std::string_view text) {
  if (text == "auto") return std::nullopt;
  const double base = number_option(text, 0, 65500);
  return static_cast<std::uint16_t>(base == 0 ? 30000 : base);
}

std::vector<Option> options_of(Request& request) {
  ur::Settings& settings = request.settings;
  return {
      {"--address", "ADDRESS", "where to listen (127.0.2.2)", [&](auto text) { settings.address = text; }},
      {"--port-base", "N|auto", "ports N-1, N+1, N+2, N+11, N+12; 0 means 30000; auto takes free ones",
       [&](auto text) { settings.port_base = port_base(text); }},
      {"--speed", "N", "robot time runs N times faster (1)",
       [&](auto text) { settings.speed = number_option(text, 0.001, 100000); }},
      control_option(settings.control),
      {"--start-off", "", "start powered off, not ready to run",
       [&](auto) { settings.mode = ur::RobotMode::PowerOff; }},
      {"--die-with-parent", "", "end when the starting process ends", [&](auto) { request.die_with_parent = true; }},
  };
}

}  // namespace

int main(int argc, char** argv) {
  const int parent = ::getppid();
  Request request;
  const std::vector<Option> options = options_of(request);
  try {
    if (!parse_options({argv + 1, argv + argc}, options)) {
      std::fputs(describe_options("trb-virtual-ur", "a virtual UR3 controller", options).c_str(), stdout);
      return 0;
    }
    const Fd end = catch_end_signals();
    if (request.die_with_parent && !die_with_parent(parent)) return 1;
    ur::VirtualUr(request.settings).run(end);
    return 0;
  } catch (const std::exception& error) {
    std::fprintf(stderr, "trb-virtual-ur: %s\n", error.what());
    return 2;
  }
}
