#include <doctest/doctest.h>

#include <algorithm>

#include "services/simulator/job/job.hpp"
#include "services/simulator/job/world_job.hpp"

using namespace trb;
using namespace trb::simulator;

namespace {

/// An arm that picks left when it is cold, else right; the thermometer is at the belt.
const std::string kHall = R"("fleet": [
  {"id": "belt", "profile": {"capabilities": ["belt"], "skills": [{"name": "run", "capability": "belt", "timeout_s": 60}]}},
  {"id": "arm", "profile": {"capabilities": ["grip"], "skills": [{"name": "pick", "capability": "grip", "timeout_s": 60},
    {"name": "place", "capability": "grip", "timeout_s": 60}]}}],
 "scenario": {"name": "two sides", "tasks": [
  {"id": "run", "robot": "belt", "skill": "run"},
  {"id": "left", "robot": "arm", "skill": "pick", "after": ["run"],
   "when": {"sensor": "temperature", "of": "belt", "op": "<=", "value": 20, "unit": "degC"}},
  {"id": "right", "robot": "arm", "skill": "place", "after": ["run"],
   "when": {"sensor": "temperature", "of": "belt", "op": ">", "value": 20, "unit": "degC"}}]})";

std::string hall_job(const std::string& more) {
  return R"({"protocol": "talkrobots", )" + kHall + more + "}";
}

std::string thermometer(const std::string& course) {
  return R"(, "sensor_values": [{"node": "belt", "name": "temperature", "unit": "degC", )" + course + "}]";
}

/// How often each side was done.
struct Sides {
  std::uint32_t left = 0, right = 0;
  bool operator==(const Sides&) const = default;
};

Sides sides_at(const std::string& course) {
  ConfigFaults faults;
  const Job job = read_job(hall_job(thermometer(course)), faults);
  REQUIRE_MESSAGE(faults.empty(), to_text(faults));
  world::World world(*job.world);
  const world::Played played = world.play();
  CHECK(played.broken.empty());
  CHECK(played.state == RunState::finished);
  return {world.witness().done("left"), world.witness().done("right")};
}

std::vector<std::string> keys_of(const std::string& more) {
  ConfigFaults faults;
  static_cast<void>(read_job(hall_job(more), faults));
  std::vector<std::string> out;
  for (const ConfigFault& fault : faults) out.push_back(fault.key);
  return out;
}

}  // namespace

TEST_CASE("a condition on a sensor is decided by what the sensor tells then") {
  CHECK(sides_at(R"("value": 18)") == Sides{1, 0});
  CHECK(sides_at(R"("value": 25)") == Sides{0, 1});
  // The belt runs for three seconds.
  CHECK(sides_at(R"("steps": [{"at": 0, "value": 18}, {"at": 2, "value": 25}])") == Sides{0, 1});
  CHECK(sides_at(R"("ramp": {"from": 15, "to": 60, "begin": 100, "end": 200})") == Sides{1, 0});
  CHECK(sides_at(R"("ramp": {"from": 15, "to": 60, "end": 3})") == Sides{0, 1});
}

namespace {

/// The key `steps_not_reached` of the answer, as text; empty: it has none.
std::string late_steps_of(const std::string& more) {
  ConfigFaults faults;
  const Job job = read_job(hall_job(more), faults);
  REQUIRE_MESSAGE(faults.empty(), to_text(faults));
  const Value world = world_value(world::World(*job.world).play());
  const Value* late = world.find("steps_not_reached");
  return late == nullptr ? "" : dump_json(*late);
}

}  // namespace

TEST_CASE("what a sensor was to tell behind the end is told, by the sensor's place in the job; what has come is not") {
  const std::string cut = R"(, "seconds": 10)";
  CHECK(late_steps_of(thermometer(R"("value": 18)")).empty());
  CHECK(late_steps_of(cut + thermometer(R"("steps": [{"at": 0, "value": 18}, {"at": 10, "value": 19}])")).empty());
  CHECK(
      late_steps_of(
          cut + thermometer(R"("steps": [{"at": 9, "value": 18}, {"at": 11, "value": 25}, {"at": 12, "value": 1}])")) ==
      R"([{"sensor":0,"at":11.0,"steps":2}])");
  CHECK(late_steps_of(cut + thermometer(R"("ramp": {"from": 1, "to": 2, "begin": 5, "end": 20})")) ==
        R"([{"sensor":0,"at":20.0,"steps":1}])");
  // The run is over before, and nobody asked for its end.
  const std::string two = thermometer(R"("value": 18}, {"node": "arm", "name": "load", "steps": [{"at": 0, "value": 1},
      {"at": 5000, "value": 2}])");
  CHECK(late_steps_of(two) == R"([{"sensor":1,"at":5000.0,"steps":1}])");
}

TEST_CASE("a condition may be on a sensor of the cloud") {
  const std::string hall = R"({"protocol": "talkrobots", "fleet": [{"id": "arm", "profile": {"capabilities": ["grip"],
      "skills": [{"name": "pick", "capability": "grip", "timeout_s": 60}]}}],
      "scenario": {"name": "dry", "tasks": [{"id": "pick", "robot": "arm", "skill": "pick",
      "when": {"sensor": "humidity", "of": "cloud", "op": "<", "value": 60, "unit": "percent"}}]},
      "sensor_values": [{"node": "cloud", "name": "humidity", "unit": "percent", "value": )";
  for (const std::uint32_t percent : {40U, 80U}) {
    CAPTURE(percent);
    ConfigFaults faults;
    const Job job = read_job(hall + std::to_string(percent) + "}]}", faults);
    REQUIRE_MESSAGE(faults.empty(), to_text(faults));
    world::World world(*job.world);
    const world::Played played = world.play();
    CHECK(played.broken.empty());
    CHECK(played.state == RunState::finished);
    CHECK(world.witness().done("pick") == (percent < 60 ? 1U : 0U));
  }
}

TEST_CASE("a run waits for a sensor that cannot be read yet") {
  CHECK(sides_at(R"("steps": [{"at": 0, "value": null}, {"at": 20, "value": 18}])") == Sides{1, 0});
}

TEST_CASE("a sensor's kind, unit and identity are those that its node tells, if the job leaves them out") {
  ConfigFaults faults;
  const Job job = read_job(R"({"protocol": "talkrobots", "scenario": {"name": "x", "tasks": [
      {"id": "t", "robot": "a", "skill": "go"}]}, "fleet": [{"id": "a", "profile": {"capabilities": ["legs"],
      "skills": [{"name": "go", "capability": "legs", "timeout_s": 9}],
      "plugged": [{"name": "t_2", "kind": "temperature", "unit": "degC", "identity": "S1"}]}}],
      "sensor_values": [{"node": "a", "name": "t_2", "value": 3}, {"node": "cloud", "name": "door", "value": "open"}]})",
                           faults);
  REQUIRE_MESSAGE(faults.empty(), to_text(faults));
  REQUIRE(job.world->sensors.size() == 2);
  CHECK(job.world->sensors[0].info.kind == "temperature");
  CHECK(job.world->sensors[0].info.unit == "degC");
  CHECK(job.world->sensors[0].info.identity == "S1");
  CHECK(job.world->sensors[1].info.kind == "door");
  CHECK(std::get<std::string>(job.world->sensors[1].course.at(5)) == "open");
}

TEST_CASE("what is wrong with a sensor is named, and a condition that nobody answers is refused") {
  struct Case {
    std::string more;
    std::string key;
  };
  const auto of = [](const std::string& fields) { return R"(, "sensor_values": [{)" + fields + "}]"; };
  for (const Case& one :
       {Case{"", "scenario"}, Case{thermometer(R"("value": [1])"), "sensor_values[0].value"},
        Case{thermometer(R"("value": 1, "steps": [])"), "sensor_values[0].value"},
        Case{thermometer(R"("every_s": 1)"), "sensor_values[0].value"},
        Case{thermometer(R"("steps": [])"), "sensor_values[0].steps"},
        Case{thermometer(R"("steps": [{"at": 3, "value": 1}, {"at": 3, "value": 2}])"), "sensor_values[0].steps[1].at"},
        Case{thermometer(R"("ramp": {"from": 1, "to": 2, "begin": 5, "end": 5})"), "sensor_values[0].ramp.end"},
        Case{thermometer(R"("value": 1, "every_s": 0)"), "sensor_values[0].every_s"},
        Case{of(R"("node": "roof", "name": "temperature", "value": 1)"), "sensor_values[0].node"},
        Case{of(R"("node": "belt", "name": "2 hot", "value": 1)"), "sensor_values[0].name"},
        Case{of(R"("node": "belt", "name": "stop", "value": 1)"), "sensor_values[0].name"},
        Case{of(R"("node": "belt", "name": "a", "value": 1}, {"node": "belt", "name": "a", "value": 1)"),
             "sensor_values[1].name"},
        // Another unit than the condition's.
        Case{of(R"("node": "belt", "name": "temperature", "unit": "K", "value": 1)"), "tasks[1].when.unit"},
        Case{of(R"("node": "belt", "name": "temperature", "value": 1)"), "scenario"},
        Case{of(R"("node": "arm", "name": "temperature", "unit": "degC", "value": 1)"), "scenario"}}) {
    CAPTURE(one.more);
    const auto keys = keys_of(one.more);
    CHECK(std::ranges::find(keys, one.key) != keys.end());
  }
}
