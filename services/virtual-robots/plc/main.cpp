#include "services/virtual-robots/plc/virtual_plc.hpp"
#include "services/virtual-robots/support/control.hpp"
#include "services/virtual-robots/support/robot_main.hpp"

namespace {

using namespace trb::virtual_robots;

std::vector<Option> options_of(plc::Settings& settings) {
  return {
      address_option(settings.where.address),
      {"--port", "N|auto", "the Modbus TCP port (502); auto takes a free one",
       [&](auto text) { settings.where.port = port_of(text); }},
      speed_option(settings.speed),
      {"--length-mm", "N", "how long the belt is (2000)",
       [&](auto text) { settings.conveyor.length_mm = number_option(text, 100, 60000); }},
      {"--bring-boxes", "", "a box lies at the entry whenever the belt starts with none on its way",
       [&](auto) { settings.conveyor.brings_boxes = true; }},
      control_option(settings.control),
  };
}

}  // namespace

int main(int argc, char** argv) {
  plc::Settings settings;
  return robot_main(argc, argv,
                    {"trb-virtual-plc", "a belt conveyor's controller on Modbus TCP", options_of(settings),
                     [&](const Fd& end) { plc::VirtualPlc(settings).run(end); }});
}
