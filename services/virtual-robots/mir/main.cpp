#include "services/virtual-robots/mir/virtual_mir.hpp"
#include "services/virtual-robots/support/control.hpp"
#include "services/virtual-robots/support/robot_main.hpp"
#include "services/virtual-robots/support/text.hpp"

namespace {

using namespace trb::virtual_robots;

void add_position(mir::RobotSettings& robot, std::string_view text) {
  const std::size_t equals = text.find('=');
  const auto numbers =
      equals == std::string_view::npos ? std::vector<std::string>() : split(text.substr(equals + 1), ',');
  if (numbers.size() != 3 || equals == 0) throw OptionError("a position is NAME=X,Y,DEGREES");
  robot.positions[std::string(text.substr(0, equals))] = {number_option(numbers[0], -1000, 1000),
                                                          number_option(numbers[1], -1000, 1000),
                                                          number_option(numbers[2], -360, 360)};
}

std::vector<Option> options_of(mir::Settings& settings) {
  return {
      address_option(settings.where.address),
      {"--port", "N|auto", "the port of its REST interface (80); auto takes a free one",
       [&](auto text) { settings.where.port = port_of(text); }},
      speed_option(settings.speed),
      {"--position", "NAME=X,Y,DEGREES", "a position, and the mission 'Go to NAME'; may be given again",
       [&](auto text) { add_position(settings.robot, text); }},
      {"--user", "NAME", "who may sign in (distributor); '' lets anybody in", [&](auto text) { settings.user = text; }},
      {"--password", "TEXT", "its password (distributor)", [&](auto text) { settings.password = text; }},
      control_option(settings.control),
  };
}

}  // namespace

int main(int argc, char** argv) {
  mir::Settings settings;
  return robot_main(argc, argv,
                    {"trb-virtual-mir", "a MiR's mission queue by its REST interface 2.0", options_of(settings),
                     [&](const Fd& end) { mir::VirtualMir(settings).run(end); }});
}
