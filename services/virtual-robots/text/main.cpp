#include "services/virtual-robots/support/control.hpp"
#include "services/virtual-robots/support/robot_main.hpp"
#include "services/virtual-robots/text/virtual_text.hpp"

namespace {

using namespace trb::virtual_robots;

std::vector<Option> options_of(text::Settings& settings) {
  return {
      address_option(settings.where.address),
      {"--port", "N|auto", "its port (29999); auto takes a free one",
       [&](auto text) { settings.where.port = port_of(text); }},
      {"--profile", "NAME", "dobot (the default), crlf-login or alive", [&](auto text) { settings.profile = text; }},
      {"--password", "TEXT", "what crlf-login wants to hear (secret)", [&](auto text) { settings.password = text; }},
      speed_option(settings.speed),
      control_option(settings.control),
  };
}

}  // namespace

int main(int argc, char** argv) {
  text::Settings settings;
  return robot_main(argc, argv,
                    {"trb-virtual-text", "a robot that is asked and answers in text", options_of(settings),
                     [&](const Fd& end) { text::VirtualText(settings).run(end); }});
}
