#include "common/simulation/job_sensors.hpp"

#include <doctest/doctest.h>

using namespace trb;
using namespace trb::simulation;

namespace {

/// Of an arm that tells of a thermometer.
std::map<std::string, NodeProfile> hall() {
  NodeProfile arm;
  SensorInfo& one = arm.plugged.emplace_back();
  one.name = "t_2";
  one.kind = "temperature";
  one.unit = "degC";
  one.identity = "S1";
  return {{"arm", arm}, {"belt", {}}};
}

struct Read {
  PlannedSensors sensors;
  ConfigFaults faults;
};

Read read(const std::string& sensors, std::size_t most = kMaxSensors) {
  Read out;
  const auto json = parse_json(R"({"sensor_values": [)" + sensors + "]}");
  REQUIRE(json.ok());
  ObjectReader reader(*json, "", FileFaults("job", out.faults));
  out.sensors = read_sensor_values(reader, JobNodes(hall()), most);
  reader.refuse_unknown_keys();
  return out;
}

Scenario waiting_for(const std::string& sensor, const std::string& of, const std::string& unit) {
  Condition condition;
  condition.sensor = sensor;
  condition.of = of;
  condition.unit = unit;
  Scenario out;
  Task& task = out.tasks.emplace_back();
  task.id = "pick";
  task.when.push_back(condition);
  return out;
}

std::vector<std::string> missing(const Read& of, const Scenario& scenario) {
  ConfigFaults faults;
  check_conditions(of.sensors, scenario, FileFaults("job", faults));
  std::vector<std::string> out;
  for (const ConfigFault& fault : faults) out.push_back(fault.what);
  return out;
}

}  // namespace

TEST_CASE("a sensor tells one value, steps, or a ramp") {
  const Read some = read(R"({"node": "arm", "name": "t_2", "value": 3}, {"node": "cloud", "name": "door",
      "steps": [{"at": 0, "value": null}, {"at": 5, "value": "open"}]}, {"node": "belt", "name": "load", "unit": "kg",
      "ramp": {"from": 10, "to": 20, "begin": 10, "end": 20}})");
  REQUIRE_MESSAGE(some.faults.empty(), to_text(some.faults));
  CHECK(some.sensors[0].info.kind == "temperature");
  CHECK(some.sensors[0].info.identity == "S1");
  CHECK(std::holds_alternative<std::monostate>(some.sensors[1].course.at(4)));
  CHECK(std::get<std::string>(some.sensors[1].course.at(5)) == "open");
  CHECK(std::get<double>(some.sensors[2].course.at(15)) == 15);
}

TEST_CASE("what is wrong with a sensor is named, and there are not too many") {
  struct Case {
    const char* sensor;
    const char* key;
  };
  for (const Case& one :
       {Case{R"({"name": "t", "value": 1})", "sensor_values[0].node"},
        Case{R"({"node": "roof", "name": "t", "value": 1})", "sensor_values[0].node"},
        Case{R"({"node": "arm", "name": "2 hot", "value": 1})", "sensor_values[0].name"},
        Case{R"({"node": "arm", "name": "stop", "value": 1})", "sensor_values[0].name"},
        Case{R"({"node": "arm", "name": "t"})", "sensor_values[0].value"},
        Case{R"({"node": "arm", "name": "t", "value": 1, "steps": []})", "sensor_values[0].value"},
        Case{R"({"node": "arm", "name": "t", "value": [1]})", "sensor_values[0].value"},
        Case{R"({"node": "arm", "name": "t", "steps": [{"at": 3, "value": 1}, {"at": 3, "value": 2}]})",
             "sensor_values[0].steps[1].at"},
        Case{R"({"node": "arm", "name": "t", "ramp": {"from": 1, "to": 2, "begin": 5, "end": 5}})",
             "sensor_values[0].ramp.end"},
        Case{R"({"node": "arm", "name": "t", "value": 1, "file": "/etc/passwd"})", "sensor_values[0].file"},
        Case{R"({"node": "arm", "name": "t", "value": 1}, {"node": "arm", "name": "t", "value": 1})",
             "sensor_values[1].name"}}) {
    CAPTURE(one.sensor);
    const ConfigFaults faults = read(one.sensor).faults;
    REQUIRE_FALSE(faults.empty());
    CHECK(faults[0].key == one.key);
    CHECK_FALSE(faults[0].hint.empty());
  }
  CHECK(read(R"({"node": "arm", "name": "t", "value": 1})", 0).faults.size() == 1);
}

TEST_CASE("a condition needs a sensor that tells something, in its unit") {
  const Read some = read(R"({"node": "arm", "name": "t_2", "value": 3})");
  CHECK(missing(some, waiting_for("t_2", "arm", "degC")).empty());
  CHECK(missing(some, waiting_for("temperature", "", "degC")).empty());
  CHECK(missing(some, waiting_for("t_2", "arm", "K")).size() == 1);
  CHECK(missing(some, waiting_for("t_2", "belt", "degC")).size() == 1);
  CHECK(missing(read(""), waiting_for("t_2", "arm", "degC")).size() == 1);
}

TEST_CASE("a condition on a text needs a sensor that tells a text, one on a number a number") {
  Scenario tag = waiting_for("tag", "arm", "");
  tag.tasks[0].when[0].is_text = true;
  tag.tasks[0].when[0].text = "00123";
  const auto told = [&](const std::string& value, const Scenario& scenario) {
    return missing(read(R"({"node": "arm", "name": "tag", )" + value + "}"), scenario);
  };
  CHECK(told(R"("value": "00123")", tag).empty());
  CHECK(told(R"("value": null)", tag).empty());
  CHECK(told(R"("steps": [{"at": 0, "value": null}, {"at": 3, "value": "x"}])", tag).empty());
  const auto wrong = told(R"("value": 123)", tag);
  REQUIRE(wrong.size() == 1);
  CHECK(wrong.front().ends_with("a text, but it tells a number"));
  const Scenario number = waiting_for("tag", "arm", "");
  CHECK(told(R"("value": 123)", number).empty());
  CHECK(told(R"("value": "123")", number).size() == 1);
}

TEST_CASE("a node tells of its sensor in place of the one of that name") {
  auto profiles = hall();
  plug_in(
      read(R"({"node": "arm", "name": "t_2", "unit": "K", "value": 3}, {"node": "belt", "name": "load", "value": 1})")
          .sensors,
      profiles);
  REQUIRE(profiles.at("arm").plugged.size() == 1);
  CHECK(profiles.at("arm").plugged[0].unit == "K");
  CHECK(profiles.at("belt").plugged.size() == 1);
}

TEST_CASE("a value beyond its bound is refused with that bound") {
  for (const auto& [value, bound] : {std::pair{std::string("1e15"), "1e12"}, std::pair{std::string("-2e12"), "1e12"},
                                     std::pair{'"' + std::string(256, 'x') + '"', "255"}}) {
    CAPTURE(value);
    const ConfigFaults faults = read(R"({"node": "arm", "name": "t", "value": )" + value + "}").faults;
    REQUIRE(faults.size() == 1);
    CHECK(faults[0].key == "sensor_values[0].value");
    CHECK(faults[0].hint.find(bound) != std::string::npos);
  }
}
