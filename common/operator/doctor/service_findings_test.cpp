// What the doctor says of one service, with no other key than that service's.
#include "common/operator/doctor/service_findings.hpp"

#include <doctest/doctest.h>

using namespace trb;
using namespace trb::op;

namespace {

/// In the container of ant's scheduler, which is up.
Observed well() {
  Observed seen;
  seen.node = "ant";
  seen.answers = true;
  seen.services.services = {{"router", "up", 1, 1, "1.0", 5, 0, {}, {}},
                            {"scheduler", "up", 2, 2, "1.0", 5, 0, {}, {}}};
  return seen;
}

void check_one(const Observed& seen, Weight weight, const std::string& cause, const std::string& subject) {
  const std::vector<Finding> found = diagnose_service(seen, "scheduler");
  REQUIRE(found.size() == 1);
  CHECK(found[0].weight == weight);
  CHECK(found[0].cause == cause);
  CHECK(found[0].subject == subject);
  CHECK_FALSE(found[0].hint.empty());
}

}  // namespace

TEST_CASE("a service that is up is well, whatever its node's other services and robot are") {
  Observed seen = well();
  CHECK(diagnose_service(seen, "scheduler").empty());
  seen.services.services.push_back({"mode-adapter", "down", 0, 0, "", 0, 0, {}, {}});
  seen.beacon = false;
  CHECK(diagnose_service(seen, "scheduler").empty());
}

TEST_CASE("a service that hangs, one that is down, one that the router's node.json does not name") {
  for (const std::string state : {"silent", "down"}) {
    Observed seen = well();
    seen.services.services[1].state = state;
    check_one(seen, Weight::problem, "service_down", "scheduler");
  }
  Observed unnamed = well();
  unnamed.services.services.pop_back();
  check_one(unnamed, Weight::problem, "service_down", "scheduler");
}

TEST_CASE("a service that the node's own node.json does not name is told as such, with the nearest, and is not asked") {
  Observed seen = well();
  seen.named = {"router", "schedulr"};
  seen.answers = false;
  check_one(seen, Weight::problem, "service_down", "scheduler");
  CHECK(diagnose_service(seen, "scheduler")[0].hint == "did you mean 'schedulr'?");
}

TEST_CASE("a service notes what troubles it") {
  Observed seen = well();
  seen.services.services[1].note = "the disk is full";
  check_one(seen, Weight::note, "service_note", "scheduler");
}

TEST_CASE("a service that waits for its files is not well") {
  Observed seen = well();
  seen.services.services[1].note = "it waits: the disk is full; make room";
  check_one(seen, Weight::problem, "service_waits", "scheduler");
}

TEST_CASE("no router, and a router that does not take the service's key") {
  Observed seen = well();
  seen.answers = false;
  check_one(seen, Weight::problem, "router_down", "ant");
  seen.bus_key_refused = true;
  check_one(seen, Weight::problem, "bus_key", "keys/bus/scheduler.key");
}

TEST_CASE("what is wrong with its files and its disk is told before a note") {
  Observed seen = well();
  seen.clock_set = false;
  check_one(seen, Weight::note, "clock_not_set", "ant");
  seen.faults = {{"node.json", "id", "is missing", "name it"}};
  const std::vector<Finding> found = diagnose_service(seen, "scheduler");
  REQUIRE(found.size() == 2);
  CHECK(found[0].cause == "node_folder");
  CHECK(found[1].cause == "clock_not_set");
}
