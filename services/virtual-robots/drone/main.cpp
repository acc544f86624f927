#include <unistd.h>

#include <cstdio>
#include <exception>

#include "services/virtual-robots/drone/virtual_drone.hpp"
#include "services/virtual-robots/support/options.hpp"

namespace {

using namespace trb::virtual_robots;

/** What the command line asks for. */
struct Request {
  drone::Settings settings;
  bool die_with_parent = false;
};

std::optional<std::uint16_t> port_of_commands(std::string_view text) {
  if (text == "auto") return std::nullopt;
  return static_cast<std::uint16_t>(number_option(text, 3, 65535));
}

std::vector<Option> options_of(Request& request) {
  drone::Settings& settings = request.settings;
  return {
      {"--address", "ADDRESS", "where to listen (127.0.2.6)", [&](auto text) { settings.address = text; }},
      {"--port", "N|auto", "AT commands on N (5556), navdata on N-2; auto takes free ones",
       [&](auto text) { settings.port = port_of_commands(text); }},
      {"--speed", "N", "robot time runs N times faster (1)",
       [&](auto text) { settings.speed = number_option(text, 0.001, 100000); }},
      {"--battery", "PERCENT", "the charge at the start (100)",
       [&](auto text) { settings.battery = number_option(text, 0, 100); }},
      control_option(settings.control),
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
      std::fputs(describe_options("trb-virtual-drone", "a virtual Parrot AR.Drone 2", options).c_str(), stdout);
      return 0;
    }
    const Fd end = catch_end_signals();
    if (request.die_with_parent && !die_with_parent(parent)) return 1;
    drone::VirtualDrone(request.settings).run(end);
    return 0;
  } catch (const std::exception& error) {
    std::fprintf(stderr, "trb-virtual-drone: %s\n", error.what());
    return 1;
  }
}
