#include "services/cloud-gateway/core/simulations/simulation_job.hpp"

#include <doctest/doctest.h>

using namespace trb;
using namespace trb::gateway;

namespace {

ConfigFaults faults_of(const std::string& text) {
  const auto job = parse_json(text);
  REQUIRE(job.ok());
  ConfigFaults out;
  check_simulation_job(*job, out);
  return out;
}

}  // namespace

TEST_CASE("every key that the simulator takes passes") {
  for (const char* text :
       {R"({"robots": 5, "tasks": 9})", R"({"protocol": "paper", "robots": 20000, "tasks": 1000000})",
        R"({"robots": 5, "tasks": 9, "interpreted": 5, "task_seconds": 2.5, "sensors": 1, "rate": 1, "seconds": 180,
            "local_requests": 1, "remote_requests": 1, "faulty": 4})",
        R"({"protocol": "talkrobots", "robots": 100, "tasks": 1000, "task_seconds": 3, "deviation": 1, "seconds": 600,
            "seed": 7, "link": "wifi", "faults": [{"at": 2, "kind": "fail", "node": "r1"},
            {"at": 4.5, "kind": "cut", "node": "r1", "other": "cloud"}]})",
        R"({"protocol": "talkrobots", "scenario": {}, "times": {"go_to": 3, "pick": {"mean": 2, "deviation": 0.5}},
            "task_seconds": 3, "deviation": 1, "seconds": 600, "seed": 7, "link": "vpn", "faults": []})"}) {
    CAPTURE(text);
    CHECK(faults_of(text).empty());
  }
}

TEST_CASE("every fault is named by its key, with a cure") {
  struct Case {
    const char* text;
    const char* key;
  };
  for (
      const Case& one : {
          Case{R"({"tasks": 9})", "robots"},
          Case{R"({"robots": 0, "tasks": 9})", "robots"},
          Case{R"({"robots": 20001, "tasks": 9})", "robots"},
          Case{R"({"robots": 5, "tasks": 1000001})", "tasks"},
          Case{R"({"robots": "5", "tasks": 9})", "robots"},
          Case{R"({"robots": 5, "tasks": 9, "interpreted": 6})", "interpreted"},
          Case{R"({"robots": 5, "tasks": 9, "faulty": 5})", "faulty"},
          Case{R"({"robots": 5, "tasks": 9, "task_seconds": 0})", "task_seconds"},
          Case{R"({"robots": 5, "tasks": 9, "rate": -1})", "rate"},
          Case{R"({"robots": 5, "tasks": 9, "sensors": 1001})", "sensors"},
          Case{R"({"robots": 5, "tasks": 9, "local_requests": 1e9})", "local_requests"},
          Case{R"({"robots": 5, "tasks": 9, "link": "wifi"})", "link"},
          Case{R"({"robots": 5, "tasks": 9, "trace": "/etc/passwd"})", "trace"},
          Case{R"({"protocol": "talkrobots", "robots": 5, "tasks": 9, "trace": "x"})", "trace"},
          Case{R"({"protocol": "mqtt", "robots": 5, "tasks": 9})", "protocol"},
          Case{R"({"protocol": 1, "robots": 5, "tasks": 9})", "protocol"},
          Case{R"({"protocol": "talkrobots", "robots": 101, "tasks": 9})", "robots"},
          Case{R"({"protocol": "talkrobots", "robots": 5, "tasks": 1001})", "tasks"},
          Case{R"({"protocol": "talkrobots", "robots": 5, "tasks": 9, "link": "string"})", "link"},
          Case{R"({"protocol": "talkrobots", "robots": 5, "tasks": 9, "seed": -1})", "seed"},
          Case{R"({"protocol": "talkrobots", "robots": 5, "tasks": 9, "faults": {}})", "faults"},
          Case{R"({"protocol": "talkrobots", "robots": 5, "tasks": 9, "faults": [7]})", "faults[0]"},
          Case{
              R"({"protocol": "talkrobots", "robots": 5, "tasks": 9, "faults": [{"at": 1, "kind": "burn", "node": "r0"}]})",
              "faults[0].kind"},
          Case{R"({"protocol": "talkrobots", "robots": 5, "tasks": 9, "faults": [{"at": 1, "kind": "kill"}]})",
               "faults[0].node"},
          Case{R"({"scenario": {}})", "protocol"},
          Case{R"({"protocol": "paper", "scenario": {}})", "protocol"},
          Case{R"({"protocol": "talkrobots", "scenario": {}, "robots": 5})", "robots"},
          Case{R"({"protocol": "talkrobots", "scenario": {}, "tasks": "9"})", "tasks"},
          Case{R"({"protocol": "talkrobots", "scenario": {}, "fleet": []})", "fleet"},
          Case{R"({"protocol": "talkrobots", "robots": 5, "tasks": 9, "fleet": []})", "fleet"},
          Case{R"({"protocol": "talkrobots", "scenario": {}, "trace": "x"})", "trace"},
          Case{R"({"protocol": "talkrobots", "robots": 5, "tasks": 9, "times": {"s": 1}})", "times"},
          Case{R"({"protocol": "talkrobots", "scenario": {}, "times": [3]})", "times"},
          Case{R"({"protocol": "talkrobots", "scenario": {}, "times": {"go": 0}})", "times.go"},
          Case{R"({"protocol": "talkrobots", "scenario": {}, "times": {"go": "3"}})", "times.go"},
          Case{R"({"protocol": "talkrobots", "scenario": {}, "times": {"go": {}}})", "times.go.mean"},
          Case{R"({"protocol": "talkrobots", "scenario": {}, "times": {"go": {"mean": 1, "deviation": 2}}})",
               "times.go.deviation"},
      }) {
    CAPTURE(one.text);
    const ConfigFaults faults = faults_of(one.text);
    REQUIRE(faults.size() == 1);
    CHECK(faults[0].key == one.key);
    CHECK_FALSE(faults[0].hint.empty());
  }
}

TEST_CASE("several faults are told at once, and what is no object is refused") {
  CHECK(faults_of(R"({"robots": 0, "tasks": 0, "more": 1})").size() == 3);
  CHECK_FALSE(faults_of("[]").empty());
}

TEST_CASE("the audit log has a job in words") {
  CHECK(simulation_in_words(counted_job(*parse_json(R"({"robots": 5, "tasks": 9})"))) == "paper, 5 robots, 9 tasks");
  CHECK(simulation_in_words(counted_job(*parse_json(R"({"protocol": "talkrobots", "robots": 2, "tasks": 3})"))) ==
        "talkrobots, 2 robots, 3 tasks");
}
