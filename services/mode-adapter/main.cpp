// trb-mode-adapter NODE_DIR: turns messages into the robot's language and back. See README.md.
#include "common/drivers/registry.hpp"
#include "common/service/service_main.hpp"
#include "services/mode-adapter/io/start.hpp"

int main(int argc, char** argv) {
  return trb::service_main(argc, argv,
                           {"mode-adapter", "Turns messages into the robot's language and back.", "nodes/ur3",
                            trb::adapter::start, trb::drivers::robot_transports, true});
}
