// trb-resilience NODE_DIR: alerts, and which robot takes over from one that has failed. See README.md.
#include "common/service/service_main.hpp"
#include "services/resilience/io/start.hpp"

int main(int argc, char** argv) {
  return trb::service_main(
      argc, argv,
      {"resilience",
       "Watches the fleet and its runs, raises alerts, and finds who takes over from a robot that has failed.",
       "nodes/cloud", trb::resilience::start});
}
