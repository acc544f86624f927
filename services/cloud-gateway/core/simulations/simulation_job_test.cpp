#include "services/cloud-gateway/core/simulations/simulation_job.hpp"

#include <doctest/doctest.h>

using namespace trb;
using namespace trb::gateway;

namespace {

ConfigFaults faults_of(const std::string& text) {
  const auto job = parse_json(text);
  REQUIRE(job.ok());
  ConfigFaults out;
  std::map<std::string, NodeProfile> robots;
  robots["arm"] = robots["cart"] = {};
  check_simulation_job(*job, robots, out);
  return out;
}

}  // namespace

TEST_CASE("every key that the simulator takes passes") {
  for (
      const char* text :
      {R"({"robots": 5, "tasks": 9})", R"({"protocol": "paper", "robots": 20000, "tasks": 1000000})",
       R"({"robots": 5, "tasks": 9, "interpreted": 5, "task_seconds": 2.5, "sensors": 1, "rate": 1, "seconds": 180,
            "local_requests": 1, "remote_requests": 1, "faulty": 4})",
       R"({"protocol": "talkrobots", "robots": 100, "tasks": 1000, "task_seconds": 3, "deviation": 1, "seconds": 600,
            "seed": 7, "link": "wifi", "faults": [{"at": 2, "kind": "fail", "node": "r1"},
            {"at": 4.5, "kind": "cut", "node": "r1", "other": "cloud"}]})",
       R"({"protocol": "talkrobots", "scenario": {}, "times": {"go_to": 3, "pick": {"mean": 2, "deviation": 0.5}},
            "task_seconds": 3, "deviation": 1, "seconds": 600, "seed": 7, "link": "vpn", "faults": []})",
       R"({"protocol": "talkrobots", "scenario": {}, "faults": [{"kind": "battery", "node": "arm", "percent": 9, "per_second": 1}],
            "sensor_values": [{"node": "cart", "name": "load", "ramp": {"from": 1, "to": 2, "end": 9}}]})",
       R"({"protocol": "talkrobots", "scenario": {}, "beside": [{"scenario": {}}, {"scenario": {}, "after": 604800}]})",
       R"({"protocol": "talkrobots", "robots": 3, "tasks": 9, "relays": ["r2"],
            "link": {"delay_s": 0.1, "deviation_s": 0.01, "loss": 0.001, "bytes_a_second": 5000},
            "faults": [{"kind": "partition", "nodes": ["r0"]}, {"kind": "rate", "between_s": 60}]})"}) {
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
          Case{
              R"({"protocol": "talkrobots", "robots": 2, "tasks": 9, "faults": [{"at": 1, "kind": "kill", "node": "r2"}]})",
              "faults[0].node"},
          Case{R"({"protocol": "talkrobots", "robots": 2, "tasks": 9, "link": "/etc/passwd"})", "link"},
          Case{R"({"protocol": "talkrobots", "robots": 2, "tasks": 9, "link": {"file": "/etc/passwd", "delay_s": 1}})",
               "link.file"},
          Case{R"({"protocol": "talkrobots", "robots": 2, "tasks": 9, "link": {"delay_s": 11}})", "link.delay_s"},
          Case{R"({"protocol": "talkrobots", "robots": 2, "tasks": 9, "relays": ["r2"]})", "relays"},
          Case{R"({"protocol": "talkrobots", "robots": 2, "tasks": 9, "deviation": 4})", "deviation"},
          Case{R"({"protocol": "talkrobots", "robots": 2, "tasks": 9, "until_event": 4})", "until_event"},
          Case{R"({"protocol": "talkrobots", "scenario": {}, "faults": [{"at": 1, "kind": "kill", "node": "r0"}]})",
               "faults[0].node"},
          Case{R"({"protocol": "talkrobots", "scenario": {}, "sensor_values": [{"node": "arm", "name": "t"}]})",
               "sensor_values[0].value"},
          Case{R"({"robots": 5, "tasks": 9, "sensor_values": []})", "sensor_values"},
          Case{R"({"protocol": "talkrobots", "robots": 5, "tasks": 9, "beside": []})", "beside"},
          Case{R"({"protocol": "talkrobots", "scenario": {}, "beside": {}})", "beside"},
          Case{R"({"protocol": "talkrobots", "scenario": {}, "beside": [{}, {}, {}, {}, {}, {}, {}, {}, {}, {}]})",
               "beside"},
          Case{R"({"protocol": "talkrobots", "scenario": {}, "beside": [{"scenario": {}}, {"after": 3}]})",
               "beside[1].scenario"},
          Case{R"({"protocol": "talkrobots", "scenario": {}, "beside": [{"scenario": {}, "after": -1}]})",
               "beside[0].after"},
          Case{R"({"protocol": "talkrobots", "scenario": {}, "beside": [{"scenario": {}, "after": 604801}]})",
               "beside[0].after"},
          Case{R"({"protocol": "talkrobots", "scenario": {}, "beside": [{"scenario": {}, "trace": "x"}]})",
               "beside[0].trace"},
          Case{R"({"protocol": "talkrobots", "scenario": {}, "alone": true})", "alone"},
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

TEST_CASE("of faults and sensors there are not too many") {
  std::string faults, sensors;
  for (std::size_t i = 0; i <= kMaxSimulatedFaults; ++i) faults += R"(,{"at": 1, "kind": "fail", "node": "r0"})";
  for (std::size_t i = 0; i <= kMaxSimulatedSensors; ++i)
    sensors += R"(,{"node": "r0", "value": 1, "name": "s)" + std::to_string(i) + "\"}";
  const auto found = faults_of(R"({"protocol": "talkrobots", "robots": 1, "tasks": 1, "faults": [)" + faults.substr(1) +
                               R"(], "sensor_values": [)" + sensors.substr(1) + "]}");
  REQUIRE(found.size() == 2);
  CHECK(found[0].key == "faults");
  CHECK(found[1].key == "sensor_values");
}

TEST_CASE("several faults are told at once, and what is no object is refused") {
  CHECK(faults_of(R"({"robots": 0, "tasks": 0, "more": 1})").size() == 3);
  CHECK_FALSE(faults_of("[]").empty());
}

TEST_CASE("a list has a job without what may be long") {
  const SimulationJob job = counted_job(*parse_json(R"({"protocol": "talkrobots", "robots": 2, "tasks": 3,
      "link": {"delays_s": [0.1], "loss": 0.01}, "sensor_values": [{"node": "r0", "name": "t", "value": 1}],
      "faults": [{"kind": "partition", "nodes": ["r0"]}, {"at": 1, "kind": "fail", "node": "r1"}]})"));
  CHECK(job.outline == R"({"protocol":"talkrobots","robots":2,"tasks":3,"link":{"loss":0.01},)"
                       R"("faults":[{"kind":"partition"},{"at":1,"kind":"fail","node":"r1"}]})");
  CHECK(job.text.find("delays_s") != std::string::npos);
}

TEST_CASE("the audit log has a job in words") {
  CHECK(simulation_in_words(counted_job(*parse_json(R"({"robots": 5, "tasks": 9})"))) == "paper, 5 robots, 9 tasks");
  CHECK(simulation_in_words(counted_job(*parse_json(R"({"protocol": "talkrobots", "robots": 2, "tasks": 3})"))) ==
        "talkrobots, 2 robots, 3 tasks");
}
