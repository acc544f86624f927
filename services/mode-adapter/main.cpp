// trb-mode-adapter NODE_DIR: turns messages into the robot's language and back. See README.md.
#include <cstdio>
#include <cstring>
#include <exception>

#include "services/mode-adapter/io/start.hpp"

int main(int argc, char** argv) {
  if (argc != 2 || std::strcmp(argv[1], "--help") == 0) {
    std::puts(
        "trb-mode-adapter NODE_DIR\n\nTurns messages into the robot's language and back.\n"
        "Usually started by `trb up NODE_DIR`. Example: trb-mode-adapter nodes/ur3");
    return argc == 2 ? 0 : 2;
  }
  try {
    return trb::adapter::start(argv[1]);
  } catch (const std::exception& problem) {
    std::fprintf(stderr, "trb-mode-adapter: %s\n", problem.what());
    return 1;
  }
}
