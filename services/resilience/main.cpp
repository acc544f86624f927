// trb-resilience NODE_DIR: alerts, and who takes over from a robot that has failed. See README.md.
#include <cstdio>
#include <cstring>
#include <exception>

#include "services/resilience/io/start.hpp"

int main(int argc, char** argv) {
  if (argc != 2 || std::strcmp(argv[1], "--help") == 0) {
    std::puts(
        "trb-resilience NODE_DIR\n\nWatches the fleet and its runs, raises alerts, and finds who takes over from a "
        "robot "
        "that has failed.\n"
        "Usually started by `trb up NODE_DIR`. Example: trb-resilience nodes/cloud");
    return argc == 2 ? 0 : 2;
  }
  try {
    return trb::resilience::start(argv[1]);
  } catch (const std::exception& problem) {
    std::fprintf(stderr, "trb-resilience: %s\n", problem.what());
    return 1;
  }
}
