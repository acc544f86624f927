#include "services/virtual-robots/pioneer/virtual_pioneer.hpp"
#include "services/virtual-robots/support/control.hpp"
#include "services/virtual-robots/support/robot_main.hpp"
#include "services/virtual-robots/support/text.hpp"

namespace {

using namespace trb::virtual_robots;

constexpr double kFarthest = 10000;

pioneer::Position position_of_option(std::string_view text) {
  const auto parts = split(text, ',');
  if (parts.size() != 3) throw OptionError("--pose needs X,Y,YAW");
  return {number_option(parts[0], -kFarthest, kFarthest), number_option(parts[1], -kFarthest, kFarthest),
          number_option(parts[2], -100, 100)};
}

std::vector<Option> options_of(pioneer::Settings& settings) {
  return {
      address_option(settings.address),
      {"--port", "N|auto", "the port (8101); auto takes a free one", [&](auto text) { settings.port = port_of(text); }},
      {"--name", "NAME", "the robot's name (Pioneer)", [&](auto text) { settings.start.name = text.substr(0, 60); }},
      {"--pose", "X,Y,YAW", "where it is switched on in the hall, in metres and radians (0,0,0)",
       [&](auto text) { settings.start.place = position_of_option(text); }},
      {"--battery", "PERCENT", "its charge (100)",
       [&](auto text) { settings.start.charge = number_option(text, 0, 100); }},
      speed_option(settings.speed),
      control_option(settings.control),
  };
}

}  // namespace

int main(int argc, char** argv) {
  pioneer::Settings settings;
  return robot_main(argc, argv,
                    {"trb-virtual-pioneer", "a virtual Pioneer 3 that speaks ARCOS", options_of(settings),
                     [&](const Fd& end) { pioneer::VirtualPioneer(settings).run(end); }});
}
