#include "common/simulation/job_faults.hpp"

#include <doctest/doctest.h>

using namespace trb;
using namespace trb::simulation;

namespace {

struct Read {
  std::vector<Fault> faults;
  std::vector<std::string> relays;
  ConfigFaults found;
};

/// Of three robots; `most` faults.
Read read(const std::string& faults, const std::string& more = "", std::size_t most = kMaxFaults) {
  Read out;
  const auto json = parse_json(R"({"faults": [)" + faults + "]" + more + "}");
  REQUIRE(json.ok());
  ObjectReader reader(*json, "", FileFaults("job", out.found));
  const JobNodes nodes(3);
  out.faults = read_faults(reader, nodes, most);
  out.relays = read_relays(reader, nodes);
  reader.refuse_unknown_keys();
  return out;
}

}  // namespace

TEST_CASE("each kind of fault has its own keys") {
  const Read plan = read(R"(
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
  REQUIRE_MESSAGE(plan.found.empty(), to_text(plan.found));
  REQUIRE(plan.faults.size() == 9);
  CHECK(plan.faults[0].way == Way::there);
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
  struct Case {
    const char* fault;
    const char* key;
  };
  for (const Case& one : {
           Case{R"({"at": 1, "node": "r0"})", "faults[0].kind"},
           Case{R"({"kind": "fail", "node": "r0"})", "faults[0].at"},
           Case{R"({"at": -1, "kind": "fail", "node": "r0"})", "faults[0].at"},
           Case{R"({"at": 1, "kind": "fail", "node": "cloud"})", "faults[0].node"},
           Case{R"({"at": 1, "kind": "fail", "node": "r0", "other": "r1"})", "faults[0].other"},
           Case{R"({"at": 1, "kind": "kill"})", "faults[0].node"},
           Case{R"({"at": 1, "kind": "cut", "node": "r0", "way": "up"})", "faults[0].way"},
           Case{R"({"at": 1, "kind": "cut", "node": "r0", "other": "r9"})", "faults[0].other"},
           Case{R"({"at": 1, "kind": "cut", "node": "r0", "other": "r0"})", "faults[0].other"},
           Case{R"({"kind": "heal", "node": "r0"})", "faults[0].at"},
           Case{R"({"kind": "partition", "nodes": []})", "faults[0].nodes"},
           Case{R"({"kind": "partition", "nodes": ["r0", "r7"]})", "faults[0].nodes"},
           Case{R"({"kind": "partition", "nodes": ["r0", "r0"]})", "faults[0].nodes[1]"},
           Case{R"({"kind": "partition", "nodes": ["r0", "r1", "r2", "cloud"]})", "faults[0].nodes"},
           Case{R"({"kind": "clock", "node": "r0"})", "faults[0].ahead_s"},
           Case{R"({"kind": "clock", "node": "r0", "ahead_s": 3, "is_1970": true})", "faults[0].ahead_s"},
           Case{R"({"kind": "clock", "node": "r0", "drift_ppm": 1e9})", "faults[0].drift_ppm"},
           Case{R"({"kind": "clock", "node": "r0", "ahead_s": 1.6e9})", "faults[0].ahead_s"},
           Case{R"({"kind": "clock", "node": "r0", "ahead_s": -1e10})", "faults[0].ahead_s"},
           Case{R"({"kind": "disk", "node": "r0"})", "faults[0].commit_s"},
           Case{R"({"kind": "disk", "node": "r0", "commit_s": 61})", "faults[0].commit_s"},
           Case{R"({"kind": "battery", "node": "r0", "percent": 101, "per_second": 1})", "faults[0].percent"},
           Case{R"({"kind": "battery", "node": "cloud", "percent": 1, "per_second": 1})", "faults[0].node"},
           Case{R"({"kind": "rate"})", "faults[0].between_s"},
           Case{R"({"kind": "rate", "between_s": 9, "at": 3})", "faults[0].at"},
           Case{R"({"kind": "rate", "between_s": 9, "node": "cloud"})", "faults[0].node"},
       }) {
    CAPTURE(one.fault);
    const ConfigFaults faults = read(one.fault).found;
    REQUIRE_FALSE(faults.empty());
    CHECK(faults[0].key == one.key);
    CHECK_FALSE(faults[0].hint.empty());
  }
  for (const Read& one : {read("", R"(, "relays": ["r5"])"), read(R"({"kind": "rate", "between_s": 9})", "", 0)}) {
    REQUIRE(one.found.size() == 1);
    CHECK_FALSE(one.found[0].hint.empty());
  }
}

TEST_CASE("a fleet's robots are named by their ids") {
  ConfigFaults found;
  const auto json = parse_json(R"({"faults": [{"at": 1, "kind": "kill", "node": "arm"},
      {"at": 1, "kind": "cut", "node": "arm", "other": "r0"}]})");
  ObjectReader reader(*json, "", FileFaults("job", found));
  std::map<std::string, NodeProfile> fleet;
  fleet["arm"] = fleet["belt"] = {};
  CHECK(read_faults(reader, JobNodes(fleet)).size() == 2);
  REQUIRE(found.size() == 1);
  CHECK(found[0].key == "faults[1].other");
  CHECK(found[0].hint == "use cloud, or the id of a robot of the fleet");
}
