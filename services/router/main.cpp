// trb-router NODE_DIR: registration, routing table, links to other routers. See README.md.
#include <cstdio>
#include <cstring>

#include "services/router/io/start.hpp"

int main(int argc, char** argv) {
  if (argc != 2 || std::strcmp(argv[1], "--help") == 0) {
    std::puts("trb-router NODE_DIR\n\nThe node's only door: links to the other nodes, and the bus of this one.\n"
              "Usually started by `trb up NODE_DIR`. Example: trb-router nodes/ur3");
    return argc == 2 ? 0 : 2;
  }
  try {
    return trb::router::start(argv[1]);
  } catch (const std::exception& problem) {
    std::fprintf(stderr, "trb-router: %s\n", problem.what());
    return 1;
  }
}
