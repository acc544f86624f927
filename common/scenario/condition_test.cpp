#include "common/scenario/condition.hpp"

#include <doctest/doctest.h>

#include "common/fleet/sensor_unit.hpp"
#include "common/scenario/definition.hpp"

using namespace trb;

namespace {

Condition over(Comparison op, double value) {
  return {"temperature", "conveyor", "", op, false, value, "", "degC"};
}

Condition tag(Comparison op, const std::string& text) {
  return {"tag", "", "", op, true, 0, text, ""};
}

SensorReading degrees(double value) {
  return {"temperature", "28-01", "degC", false, value, "", 1, 0, "good", 0, 0};
}

SensorReading read_tag(const std::string& text) {
  return {"tag", "", "", true, 0, text, 1, 0, "good", 0, 0};
}

ConfigFaults faults_of(const std::string& when, Condition* read = nullptr) {
  const auto json = parse_json(R"({"name":"n","tasks":[{"id":"t","robot":"r","skill":"go","when":)" + when + "}]}");
  REQUIRE_MESSAGE(json.ok(), when);
  ConfigFaults faults;
  const Scenario scenario = read_scenario(*json, "s.json", faults);
  if (read != nullptr) *read = scenario.tasks.at(0).when.at(0);
  for (const ConfigFault& fault : faults) CHECK_FALSE(fault.hint.empty());
  return faults;
}

SensorInfo thermometer(const std::string& name, const std::string& unit, const std::string& identity = "") {
  return {name, "temperature", unit, identity, "", SensorState::ok, ""};
}

ConfigFaults check_in_fleet(const Condition& condition, std::vector<SensorInfo> plugged,
                            std::vector<SensorInfo> at_robot = {}) {
  Scenario scenario;
  scenario.tasks = {{"t", "r", {}, "go", "", {}, 0, false, {condition}}};
  NodeProfile conveyor;
  conveyor.plugged = std::move(plugged);
  NodeProfile robot;
  robot.skills = {{"go", "mobile", {}, true, 60}};
  robot.plugged = std::move(at_robot);
  ConfigFaults faults;
  check_scenario(scenario, {{"r", robot}, {"conveyor", conveyor}}, "s.json", faults);
  return faults;
}

}  // namespace

TEST_CASE("a condition holds on one side of its value only") {
  CHECK(holds(over(Comparison::at_most, 20), degrees(20)));
  CHECK_FALSE(holds(over(Comparison::more, 20), degrees(20)));
  CHECK(holds(over(Comparison::more, 20), degrees(20.1)));
  CHECK_FALSE(holds(over(Comparison::less, 20), degrees(20)));
  CHECK(holds(over(Comparison::at_least, 20), degrees(20)));
  CHECK(holds(over(Comparison::equal, -0.0), degrees(0)));
  CHECK(holds(over(Comparison::unequal, 20), degrees(20.1)));
  CHECK(holds(tag(Comparison::equal, "04a1"), read_tag("04a1")));
  CHECK(holds(tag(Comparison::unequal, "04a1"), read_tag("04a2")));
}

TEST_CASE("what is stale, doubted, of another unit or no number is not believed") {
  const Condition condition = over(Comparison::more, 20);
  CHECK(believe(condition, degrees(21)).ok());
  for (const char* quality : {"stale", "bad", ""}) {
    SensorReading reading = degrees(21);
    reading.quality = quality;
    CHECK_FALSE(believe(condition, reading).ok());
  }
  SensorReading kelvin = degrees(293);
  kelvin.unit = "K";
  CHECK(believe(condition, kelvin).error().what == "its unit is 'K', not 'degC'");
  CHECK_FALSE(believe(condition, read_tag("21")).ok());
  CHECK_FALSE(believe(tag(Comparison::equal, "21"), degrees(21)).ok());
  CHECK(believe(tag(Comparison::equal, "21"), read_tag("x")).ok());
}

TEST_CASE("a condition is told in words") {
  CHECK(condition_text(over(Comparison::more, 20)) == "temperature of conveyor > 20 degC");
  CHECK(condition_text(tag(Comparison::equal, "04a1")) == "tag of any node == '04a1'");
  Condition bound = over(Comparison::more, 20.5);
  bound.identity = "28-01";
  CHECK(condition_text(bound) == "temperature with serial number 28-01 > 20.5 degC");
  CHECK(verdict_text(over(Comparison::at_most, 20), "belt", degrees(25.1)) ==
        "temperature of belt was 25.1 degC, not <= 20");
  CHECK(verdict_text(over(Comparison::more, 20), "belt", degrees(25.1)) == "temperature of belt was 25.1 degC, > 20");
  CHECK(verdict_text(tag(Comparison::equal, "a"), "belt", read_tag("b")) == "tag of belt was 'b', not == 'a'");
}

TEST_CASE("a sensor is found by its serial number, else its name, else its kind") {
  std::vector<SensorInfo> plugged{thermometer("b", "degC", "7"), thermometer("a", "degC"),
                                  thermometer("outside", "degC", "9")};
  Condition condition = over(Comparison::more, 20);
  CHECK(find_sensor(plugged, condition)->name == "a");
  plugged[1].state = SensorState::failed;
  CHECK(find_sensor(plugged, condition)->name == "b");
  condition.sensor = "outside";
  CHECK(find_sensor(plugged, condition)->name == "outside");
  condition.identity = "7";
  CHECK(find_sensor(plugged, condition)->name == "b");
  condition.identity = "8";
  CHECK(find_sensor(plugged, condition) == nullptr);
}

TEST_CASE("a condition is read from a scenario file, and every fault of it told") {
  Condition read;
  CHECK(faults_of(R"({"sensor":"temperature","of":"conveyor","op":"<=","value":20,"unit":"degC"})", &read).empty());
  CHECK(read == over(Comparison::at_most, 20));
  CHECK(faults_of(R"({"sensor":"tag","op":"==","value":"04a1"})", &read).empty());
  CHECK(read == tag(Comparison::equal, "04a1"));
  CHECK(faults_of(R"({"sensor":"t","identity":"7","op":">","value":-1.5,"unit":""})", &read).empty());
  CHECK(read.identity == "7");

  const auto first = [](const std::string& when) {
    const ConfigFaults faults = faults_of(when);
    REQUIRE_MESSAGE(faults.size() == 1, to_text(faults));
    return faults[0].key;
  };
  CHECK(first(R"({"op":">","value":1,"unit":""})") == "tasks[0].when.sensor");
  CHECK(first(R"({"sensor":"a b","op":">","value":1,"unit":""})") == "tasks[0].when.sensor");
  CHECK(first(R"({"sensor":"t","of":"A B","op":">","value":1,"unit":""})") == "tasks[0].when.of");
  CHECK(first(R"({"sensor":"t","op":"=>","value":1,"unit":""})") == "tasks[0].when.op");
  CHECK(first(R"({"sensor":"t","value":1,"unit":""})") == "tasks[0].when.op");
  CHECK(first(R"({"sensor":"t","op":">","value":"x"})") == "tasks[0].when.op");
  CHECK(first(R"({"sensor":"t","op":">","value":true,"unit":""})") == "tasks[0].when.value");
  CHECK(first(R"({"sensor":"t","op":">","unit":""})") == "tasks[0].when.value");
  CHECK(first(R"({"sensor":"t","op":">","value":1})") == "tasks[0].when.unit");
  CHECK(first(R"({"sensor":"t","op":"==","value":"x","unit":"m"})") == "tasks[0].when.unit");
  CHECK(faults_of(R"({"sensor":"t","op":"==","value":"x","unit":""})").empty());
  CHECK(first(R"({"sensor":"t","op":">","value":1,"unit":7})") == "tasks[0].when.unit");
  CHECK(first(R"({"sensor":"t","op":">","value":1,"unit":"","than":2})") == "tasks[0].when.than");
  CHECK(first("7") == "tasks[0].when");
  CHECK(faults_of(R"({"op":"no","value":[]})").size() == 4);
}

TEST_CASE("a condition is checked against the fleet: what is not plugged in yet may wait") {
  const Condition condition = over(Comparison::more, 20);
  CHECK(check_in_fleet(condition, {thermometer("temperature", "degC")}).empty());
  CHECK(check_in_fleet(condition, {thermometer("other", "degC")}).empty());
  const ConfigFaults none = check_in_fleet(condition, {});
  REQUIRE(none.size() == 1);
  CHECK(none[0].may_wait);
  CHECK(none[0].what == "temperature of conveyor: there is no such sensor now");
  const ConfigFaults unit = check_in_fleet(condition, {thermometer("temperature", "K")});
  REQUIRE(unit.size() == 1);
  CHECK(unit[0].key == "tasks[0].when.unit");
  CHECK_FALSE(unit[0].may_wait);
  Condition elsewhere = condition;
  elsewhere.of = "convejor";
  REQUIRE(check_in_fleet(elsewhere, {}).size() == 1);
  CHECK(check_in_fleet(elsewhere, {})[0].hint == "did you mean 'conveyor'?");
  Condition anywhere = condition;
  anywhere.of = "";
  CHECK(check_in_fleet(anywhere, {thermometer("temperature", "degC")}).empty());
}

TEST_CASE("a unit that nobody knows yet is a warning, and says how to learn it") {
  Condition condition = over(Comparison::more, 20);
  SensorInfo fed = thermometer("temperature", "");
  fed.detail = kUnitNotRead;
  const ConfigFaults not_read = check_in_fleet(condition, {fed});
  REQUIRE(not_read.size() == 1);
  CHECK(not_read[0].key == "tasks[0].when.unit");
  CHECK(not_read[0].what == "temperature of conveyor: its unit is not known yet");
  CHECK(not_read[0].hint == "trb sensor read temperature --of conveyor, then check again");
  CHECK(not_read[0].may_wait);
  const ConfigFaults no_unit = check_in_fleet(condition, {thermometer("temperature", "")});
  REQUIRE(no_unit.size() == 1);
  CHECK(no_unit[0].what == "temperature of conveyor has told no unit so far, not 'degC'");
  CHECK(no_unit[0].may_wait);
  condition.unit = "";
  CHECK(check_in_fleet(condition, {thermometer("temperature", "")}).empty());
  CHECK(check_in_fleet(condition, {fed}).size() == 1);  // it may have one
  CHECK(check_in_fleet(tag(Comparison::equal, "04a1"), {fed, {"tag", "tag", "", "", "", SensorState::ok, ""}}).empty());
}

TEST_CASE("of several sensors one that fits is enough, and one that may fit yet is told before one that cannot") {
  Condition condition = over(Comparison::more, 20);
  condition.of = "";
  SensorInfo fed = thermometer("temperature", "");
  fed.detail = kUnitNotRead;
  const SensorInfo kelvin = thermometer("temperature", "K");
  CHECK(check_in_fleet(condition, {kelvin}, {thermometer("temperature", "degC")}).empty());
  for (const auto& [first, second] : {std::pair(kelvin, fed), std::pair(fed, kelvin)}) {
    const ConfigFaults faults = check_in_fleet(condition, {first}, {second});
    REQUIRE(faults.size() == 1);
    CHECK(faults[0].may_wait);
    CHECK(faults[0].what == "temperature of any node: its unit is not known yet");
  }
}

TEST_CASE("a text is told not to fit a sensor of numbers, whose unit shows it") {
  Condition text = over(Comparison::equal, 0);
  text.is_text = true;
  text.text = "warm";
  text.unit = "";
  const ConfigFaults faults = check_in_fleet(text, {thermometer("temperature", "degC")});
  REQUIRE(faults.size() == 1);
  CHECK(faults[0].key == "tasks[0].when.value");
  CHECK(faults[0].what == "temperature of conveyor has the unit 'degC', so it tells numbers, not texts");
  CHECK(faults[0].may_wait);
}

TEST_CASE("two nodes that claim one serial number are told before the run would wait for them") {
  Condition condition = over(Comparison::more, 20);
  condition.of = "";
  condition.identity = "7";
  SensorInfo mine = thermometer("temperature", "degC");
  mine.identity = "7";
  SensorInfo claimed = mine;
  CHECK(check_in_fleet(condition, {mine}).empty());
  const ConfigFaults two = check_in_fleet(condition, {mine}, {claimed});
  REQUIRE(two.size() == 1);
  CHECK(two[0].key == "tasks[0].when.of");
  CHECK(two[0].what == "temperature with serial number 7: 'conveyor' and 'r' both say that they have it");
  CHECK(two[0].may_wait);
  condition.of = "conveyor";
  CHECK(check_in_fleet(condition, {mine}, {claimed}).empty());
  condition.of = "";
  claimed.state = SensorState::failed;
  CHECK(check_in_fleet(condition, {mine}, {claimed}).empty());
}
