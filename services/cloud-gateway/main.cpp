// trb-cloud-gateway NODE_DIR: the API and the live stream for people. See README.md.
#include "common/service/service_main.hpp"
#include "services/cloud-gateway/io/start.hpp"

int main(int argc, char** argv) {
  return trb::service_main(argc, argv,
                           {"cloud-gateway", "Serves the fleet to people: an API over HTTPS and a live stream.",
                            "nodes/cloud", trb::gateway::start});
}
