#include "services/virtual-robots/rws/virtual_rws.hpp"
#include "services/virtual-robots/support/control.hpp"
#include "services/virtual-robots/support/robot_main.hpp"

namespace {

using namespace trb::virtual_robots;

std::vector<Option> options_of(rws::Settings& settings) {
  return {
      address_option(settings.where.address),
      {"--port", "N|auto", "the port of its web services (80); auto takes a free one",
       [&](auto text) { settings.where.port = port_of(text); }},
      speed_option(settings.speed),
      {"--user", "NAME", "who may sign in (Default User)", [&](auto text) { settings.access.user = text; }},
      {"--password", "TEXT", "its password (robotics)", [&](auto text) { settings.access.password = text; }},
      {"--nonce-uses", "N", "requests for which one nonce is good (100)",
       [&](auto text) { settings.access.nonce_uses = static_cast<unsigned>(number_option(text, 1, 1e6)); }},
      {"--sessions", "N", "how many sessions there may be (70)",
       [&](auto text) { settings.access.most_sessions = static_cast<std::size_t>(number_option(text, 1, 1e6)); }},
      control_option(settings.control),
  };
}

}  // namespace

int main(int argc, char** argv) {
  rws::Settings settings;
  return robot_main(argc, argv,
                    {"trb-virtual-abb-rws", "a virtual ABB by its web services (RWS 1.0)", options_of(settings),
                     [&](const Fd& end) { rws::VirtualRws(settings).run(end); }});
}
