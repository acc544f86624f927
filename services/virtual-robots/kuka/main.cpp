#include "services/virtual-robots/kuka/virtual_kuka.hpp"
#include "services/virtual-robots/support/control.hpp"
#include "services/virtual-robots/support/robot_main.hpp"
#include "services/virtual-robots/support/text.hpp"

namespace {

using namespace trb::virtual_robots;

kuka::Failure failure_of(std::string_view text) {
  const std::size_t colon = text.find(':');
  kuka::Failure failure{std::string(text.substr(0, colon)), std::nullopt};
  if (colon != std::string_view::npos) failure.call = static_cast<int>(number_option(text.substr(colon + 1), 1, 1e6));
  return failure;
}

std::vector<Option> options_of(kuka::Settings& settings) {
  return {
      address_option(settings.address),
      {"--port", "N|auto", "the C3 server's port (7000); auto takes a free one",
       [&](auto text) { settings.port = port_of(text); }},
      speed_option(settings.speed),
      {"--fail", "SKILL[:N]", "its Nth call fails, or every one; repeated: several",
       [&](auto text) { settings.failures.push_back(failure_of(text)); }},
      control_option(settings.control),
  };
}

}  // namespace

int main(int argc, char** argv) {
  kuka::Settings settings;
  return robot_main(argc, argv,
                    {"trb-virtual-kuka", "a virtual KUKA with a C3 server", options_of(settings),
                     [&](const Fd& end) { kuka::VirtualKuka(settings).run(end); }});
}
