#include "services/virtual-robots/abb/virtual_abb.hpp"
#include "services/virtual-robots/support/control.hpp"
#include "services/virtual-robots/support/robot_main.hpp"
#include "services/virtual-robots/support/text.hpp"

namespace {

using namespace trb::virtual_robots;

abb::Failure failure_of(std::string_view text) {
  const std::size_t colon = text.find(':');
  abb::Failure failure{static_cast<int>(number_option(text.substr(0, colon), 0, 9999)), std::nullopt};
  if (colon != std::string_view::npos) failure.call = static_cast<int>(number_option(text.substr(colon + 1), 1, 1e6));
  return failure;
}

void set_ports(abb::Settings& settings, std::string_view text) {
  settings.port = port_of(text, 65534);
  settings.service_port = static_cast<std::uint16_t>(settings.port == 0 ? 0 : settings.port + 1);
}

std::vector<Option> options_of(abb::Settings& settings) {
  return {
      address_option(settings.address),
      {"--port", "N|auto", "the program's port (5000), and N+1 the service task's; auto takes free ones",
       [&](auto text) { set_ports(settings, text); }},
      speed_option(settings.speed),
      {"--fail", "CODE[:N]", "the Nth request of that code fails, or every one; repeated: several",
       [&](auto text) { settings.failures.push_back(failure_of(text)); }},
      control_option(settings.control),
  };
}

}  // namespace

int main(int argc, char** argv) {
  abb::Settings settings;
  return robot_main(argc, argv,
                    {"trb-virtual-abb", "a virtual ABB with a RAPID server and its service task", options_of(settings),
                     [&](const Fd& end) { abb::VirtualAbb(settings).run(end); }});
}
