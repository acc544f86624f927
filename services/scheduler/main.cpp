// trb-scheduler NODE_DIR: executes the node's tasks and passes the baton on. See README.md.
#include <cstdio>
#include <cstring>

#include "services/scheduler/io/start.hpp"

int main(int argc, char** argv) {
  if (argc != 2 || std::strcmp(argv[1], "--help") == 0) {
    std::puts(
        "trb-scheduler NODE_DIR\n\nExecutes the node's tasks, passes the baton on, keeps the runs' journal.\n"
        "Usually started by `trb up NODE_DIR`. Example: trb-scheduler nodes/ur3");
    return argc == 2 ? 0 : 2;
  }
  try {
    return trb::scheduler::start(argv[1]);
  } catch (const std::exception& problem) {
    std::fprintf(stderr, "trb-scheduler: %s\n", problem.what());
    return 1;
  }
}
