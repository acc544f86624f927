#include <unistd.h>

#include <cstdio>
#include <exception>

#include "services/virtual-robots/pioneer/virtual_pioneer.hpp"
#include "services/virtual-robots/support/options.hpp"
#include "services/virtual-robots/support/text.hpp"

namespace {

using namespace trb::virtual_robots;

/** What the command line asks for. */
struct Request {
  pioneer::Settings settings;
  bool die_with_parent = false;
};

constexpr double kFarthest = 10000;

std::uint16_t port_of_option(std::string_view text) {
  return text == "auto" ? std::uint16_t{0} : static_cast<std::uint16_t>(number_option(text, 1, 65535));
}

pioneer::Position position_of_option(std::string_view text) {
  const auto parts = split(text, ',');
  if (parts.size() != 3) throw OptionError("--pose needs X,Y,YAW");
  return {number_option(parts[0], -kFarthest, kFarthest), number_option(parts[1], -kFarthest, kFarthest),
          number_option(parts[2], -100, 100)};
}

std::vector<Option> options_of(Request& request) {
  pioneer::Settings& settings = request.settings;
  return {
      {"--address", "ADDRESS", "where to listen (127.0.2.2)", [&](auto text) { settings.address = text; }},
      {"--port", "N|auto", "the port (8101); auto takes a free one",
       [&](auto text) { settings.port = port_of_option(text); }},
      {"--name", "NAME", "the robot's name (Pioneer)", [&](auto text) { settings.start.name = text.substr(0, 60); }},
      {"--pose", "X,Y,YAW", "where it is switched on in the hall, in metres and radians (0,0,0)",
       [&](auto text) { settings.start.place = position_of_option(text); }},
      {"--battery", "PERCENT", "its charge (100)",
       [&](auto text) { settings.start.charge = number_option(text, 0, 100); }},
      {"--speed", "N", "robot time runs N times faster (1)",
       [&](auto text) { settings.speed = number_option(text, 0.001, 1000); }},
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
      std::fputs(describe_options("trb-virtual-pioneer", "a virtual Pioneer 3 that speaks ARCOS", options).c_str(),
                 stdout);
      return 0;
    }
    const Fd end = catch_end_signals();
    if (request.die_with_parent && !die_with_parent(parent)) return 1;
    pioneer::VirtualPioneer(request.settings).run(end);
    return 0;
  } catch (const std::exception& error) {
    std::fprintf(stderr, "trb-virtual-pioneer: %s\n", error.what());
    return 2;
  }
}
