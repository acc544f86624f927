#include <unistd.h>

#include <cstdio>
#include <exception>

#include "services/virtual-robots/mir/virtual_mir.hpp"
#include "services/virtual-robots/support/options.hpp"
#include "services/virtual-robots/support/text.hpp"

namespace {

using namespace trb::virtual_robots;

/** What the command line asks for. */
struct Request {
  mir::Settings settings;
  bool die_with_parent = false;
};

void add_position(mir::RobotSettings& robot, std::string_view text) {
  const std::size_t equals = text.find('=');
  const auto numbers =
      equals == std::string_view::npos ? std::vector<std::string>() : split(text.substr(equals + 1), ',');
  if (numbers.size() != 3 || equals == 0) throw OptionError("a position is NAME=X,Y,DEGREES");
  robot.positions[std::string(text.substr(0, equals))] = {number_option(numbers[0], -1000, 1000),
                                                          number_option(numbers[1], -1000, 1000),
                                                          number_option(numbers[2], -360, 360)};
}

std::vector<Option> options_of(Request& request) {
  mir::Settings& settings = request.settings;
  return {
      {"--address", "ADDRESS", "where to listen (127.0.2.2)", [&](auto text) { settings.where.address = text; }},
      {"--port", "N|auto", "the port of its REST interface (80); auto takes a free one",
       [&](auto text) {
         settings.where.port = text == "auto" ? 0 : static_cast<std::uint16_t>(number_option(text, 1, 65535));
       }},
      {"--speed", "N", "robot time runs N times faster (1)",
       [&](auto text) { settings.speed = number_option(text, 0.001, 100000); }},
      {"--position", "NAME=X,Y,DEGREES", "a position, and the mission 'Go to NAME'; may be given again",
       [&](auto text) { add_position(settings.robot, text); }},
      {"--user", "NAME", "who may sign in (distributor); '' lets anybody in", [&](auto text) { settings.user = text; }},
      {"--password", "TEXT", "its password (distributor)", [&](auto text) { settings.password = text; }},
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
      std::fputs(
          describe_options("trb-virtual-mir", "a MiR's mission queue by its REST interface 2.0", options).c_str(),
          stdout);
      return 0;
    }
    const Fd end = catch_end_signals();
    if (request.die_with_parent && !die_with_parent(parent)) return 1;
    mir::VirtualMir(request.settings).run(end);
    return 0;
  } catch (const std::exception& error) {
    std::fprintf(stderr, "trb-virtual-mir: %s\n", error.what());
    return 2;
  }
}
