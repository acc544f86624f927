// trb-scheduler NODE_DIR: executes the node's tasks and passes the baton on. See README.md.
#include "common/service/service_main.hpp"
#include "services/scheduler/io/start.hpp"

int main(int argc, char** argv) {
  return trb::service_main(argc, argv,
                           {"scheduler", "Executes the node's tasks, passes the baton on, keeps the runs' journal.",
                            "nodes/ur3", trb::scheduler::start});
}
