// trb-sensor-bus NODE_DIR: the sensors that are plugged into a node's PC. See README.md.
#include <cstdio>
#include <cstring>
#include <exception>

#include "services/sensor-bus/io/start.hpp"

int main(int argc, char** argv) {
  if (argc != 2 || std::strcmp(argv[1], "--help") == 0) {
    std::puts(
        "trb-sensor-bus NODE_DIR\n\nTells the fleet of the sensors plugged into this node, and their values over "
        "D-Bus.\n"
        "Usually started by `trb up NODE_DIR`. Example: trb-sensor-bus nodes/conveyor");
    return argc == 2 ? 0 : 2;
  }
  try {
    return trb::sensor::start(argv[1]);
  } catch (const std::exception& problem) {
    std::fprintf(stderr, "trb-sensor-bus: %s\n", problem.what());
    return 1;
  }
}
