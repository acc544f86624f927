// trb-router NODE_DIR: registration, routing table, links to other routers. See README.md.
#include "common/service/service_main.hpp"
#include "services/router/io/start.hpp"

int main(int argc, char** argv) {
  return trb::service_main(argc, argv,
                           {"router", "The node's only door: links to the other nodes, and the bus of this one.",
                            "nodes/ur3", trb::router::start});
}
