#include "services/virtual-robots/support/control.hpp"
#include "services/virtual-robots/support/robot_main.hpp"
#include "services/virtual-robots/ur/virtual_ur.hpp"

namespace {

using namespace trb::virtual_robots;

std::optional<std::uint16_t> port_base(std::string_view text) {
  if (text == "auto") return std::nullopt;
  const double base = number_option(text, 0, 65500);
  return static_cast<std::uint16_t>(base == 0 ? 30000 : base);
}

std::vector<Option> options_of(ur::Settings& settings) {
  return {
      address_option(settings.address),
      {"--port-base", "N|auto", "ports N-1, N+1, N+2, N+4, N+11, N+12; 0 means 30000; auto takes free ones",
       [&](auto text) { settings.port_base = port_base(text); }},
      speed_option(settings.speed),
      control_option(settings.control),
      {"--programs", "DIR", "the folder from which the dashboard loads programs (URScript)",
       [&](auto text) { settings.programs = std::string(text); }},
      {"--start-off", "", "start powered off, not ready to run",
       [&](auto) { settings.mode = ur::RobotMode::power_off; }},
  };
}

}  // namespace

int main(int argc, char** argv) {
  ur::Settings settings;
  return robot_main(argc, argv,
                    {"trb-virtual-ur", "a virtual UR3 controller", options_of(settings),
                     [&](const Fd& end) { ur::VirtualUr(settings).run(end); }});
}
