#include "services/simulator/job/fault_job.hpp"

#include <doctest/doctest.h>

#include "services/simulator/job/test/refused_job.hpp"

using namespace trb;
using namespace trb::simulator;
using namespace trb::simulator::test;
using world::FaultKind;

namespace {

std::string faulty_job(const std::string& faults, const std::string& more = "") {
  return R"({"protocol": "talkrobots", "robots": 3, "tasks": 4, "faults": [)" + faults + "]" + more + "}";
}

world::WorldPlan faulty_plan(const std::string& faults, const std::string& more = "") {
  ConfigFaults found;
  Job job = read_job(faulty_job(faults, more), found);
  REQUIRE_MESSAGE(found.empty(), to_text(found));
  return *job.world;
}

}  // namespace

TEST_CASE("each kind of fault has its own keys") {
  const auto plan = faulty_plan(R"(
      {"at": 1, "kind": "cut", "node": "r0", "other": "r1", "way": "there"},
      {"kind": "partition", "nodes": ["r0", "r1"]},
      {"at": 9, "kind": "heal", "nodes": ["r0", "r1"]},
      {"kind": "clock", "node": "r2", "is_1970": true},
      {"at": 2, "kind": "clock", "node": "cloud", "ahead_s": -30, "drift_ppm": 200},
      {"at": 3, "kind": "disk", "node": "cloud", "commit_s": 0.5},
      {"kind": "battery", "node": "r1", "percent": 40, "per_second": 2},
      {"kind": "rate", "between_s": 100, "repair_s": 5},
      {"at": 4, "kind": "repair", "node": "r1"})",
                                R"(, "relays": ["cloud", "r2"])");
  REQUIRE(plan.faults.size() == 9);
  CHECK(plan.faults[0].way == world::Way::there);
  CHECK(plan.faults[1].from_start);
  CHECK(plan.faults[2].nodes == std::vector<std::string>{"r0", "r1"});
  CHECK(plan.faults[3].clock.is_1970);
  CHECK(plan.faults[4].clock.ahead_s == -30);
  CHECK(plan.faults[4].clock.drift_ppm == 200);
  CHECK_FALSE(plan.faults[4].from_start);
  CHECK(plan.faults[5].commit_s == 0.5);
  CHECK(plan.faults[6].battery.per_second == 2);
  CHECK(plan.faults[7].rate.between_s == 100);
  CHECK(plan.faults[7].rate.repair_s == 5);
  CHECK(plan.relays == std::vector<std::string>{"cloud", "r2"});
}

TEST_CASE("a fault that cannot be is refused by its field's name") {
  for (const Wrong& one : {
           Wrong{R"({"at": 1, "node": "r0"})", "faults[0].kind"},
           Wrong{R"({"kind": "fail", "node": "r0"})", "faults[0].at"},
           Wrong{R"({"at": -1, "kind": "fail", "node": "r0"})", "faults[0].at"},
           Wrong{R"({"at": 1, "kind": "fail", "node": "cloud"})", "faults[0].node"},
           Wrong{R"({"at": 1, "kind": "fail", "node": "r0", "other": "r1"})", "faults[0].other"},
           Wrong{R"({"at": 1, "kind": "kill"})", "faults[0].node"},
           Wrong{R"({"at": 1, "kind": "cut", "node": "r0", "way": "up"})", "faults[0].way"},
           Wrong{R"({"at": 1, "kind": "cut", "node": "r0", "other": "r9"})", "faults[0].other"},
           Wrong{R"({"at": 1, "kind": "cut", "node": "r0", "other": "r0"})", "faults[0].other"},
           Wrong{R"({"kind": "heal", "node": "r0"})", "faults[0].at"},
           Wrong{R"({"kind": "partition", "nodes": []})", "faults[0].nodes"},
           Wrong{R"({"kind": "partition", "nodes": ["r0", "r7"]})", "faults[0].nodes"},
           Wrong{R"({"kind": "partition", "nodes": ["r0", "r0"]})", "faults[0].nodes[1]"},
           Wrong{R"({"kind": "partition", "nodes": ["r0", "r1", "r2", "cloud"]})", "faults[0].nodes"},
           Wrong{R"({"kind": "clock", "node": "r0"})", "faults[0].ahead_s"},
           Wrong{R"({"kind": "clock", "node": "r0", "ahead_s": 3, "is_1970": true})", "faults[0].ahead_s"},
           Wrong{R"({"kind": "clock", "node": "r0", "drift_ppm": 1e9})", "faults[0].drift_ppm"},
           Wrong{R"({"kind": "disk", "node": "r0"})", "faults[0].commit_s"},
           Wrong{R"({"kind": "disk", "node": "r0", "commit_s": 61})", "faults[0].commit_s"},
           Wrong{R"({"kind": "battery", "node": "r0", "percent": 101, "per_second": 1})", "faults[0].percent"},
           Wrong{R"({"kind": "battery", "node": "cloud", "percent": 1, "per_second": 1})", "faults[0].node"},
           Wrong{R"({"kind": "rate"})", "faults[0].between_s"},
           Wrong{R"({"kind": "rate", "between_s": 9, "at": 3})", "faults[0].at"},
           Wrong{R"({"kind": "rate", "between_s": 9, "node": "cloud"})", "faults[0].node"},
       }) {
    check_refused(faulty_job(one.text), one.key);
  }
  check_refused(faulty_job("", R"(, "relays": ["r5"])"), "relays");
}
