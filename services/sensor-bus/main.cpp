// trb-sensor-bus NODE_DIR: the sensors that are plugged into a node's PC. See README.md.
#include "common/service/service_main.hpp"
#include "services/sensor-bus/io/start.hpp"

int main(int argc, char** argv) {
  return trb::service_main(
      argc, argv,
      {"sensor-bus", "Tells the fleet of the sensors plugged into this node, and their values over D-Bus.",
       "nodes/conveyor", trb::sensor::start});
}
