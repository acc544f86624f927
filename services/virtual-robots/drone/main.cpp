#include "services/virtual-robots/drone/virtual_drone.hpp"
#include "services/virtual-robots/support/control.hpp"
#include "services/virtual-robots/support/robot_main.hpp"

namespace {

using namespace trb::virtual_robots;

std::optional<std::uint16_t> port_of_commands(std::string_view text) {
  if (text == "auto") return std::nullopt;
  return static_cast<std::uint16_t>(number_option(text, 3, 65535));
}

std::vector<Option> options_of(drone::Settings& settings) {
  return {
      address_option(settings.address, "127.0.2.6"),
      {"--port", "N|auto", "AT commands on N (5556), navdata on N-2; auto takes free ones",
       [&](auto text) { settings.port = port_of_commands(text); }},
      speed_option(settings.speed),
      {"--battery", "PERCENT", "the charge at the start (100)",
       [&](auto text) { settings.battery = number_option(text, 0, 100); }},
      control_option(settings.control),
  };
}

}  // namespace

int main(int argc, char** argv) {
  drone::Settings settings;
  return robot_main(argc, argv,
                    {"trb-virtual-drone", "a virtual Parrot AR.Drone 2", options_of(settings),
                     [&](const Fd& end) { drone::VirtualDrone(settings).run(end); }});
}
