// What a skill may send, and the registers of its command.
#include "common/drivers/modbus/written_bounds.hpp"

#include <doctest/doctest.h>

#include "tests/support/node_folder.hpp"

using namespace trb;

namespace {

/// The faults of a conveyor whose skill has these parameters and this data, and whose command writes these lines.
ConfigFaults faults_of(const std::string& parameters, const std::string& data, const std::string& writes,
                       const std::string& further = {}) {
  const NodeFolder folder("ur");
  folder.write("commands.json", R"({"ur": {"transport": "modbus", "values": {"running": "coil 0", "state": "input 0",
    "speed": "holding 0 uint16 * 0.001", "jog": "holding 1 int16"}, "commands": {"go": ")" +
                                    writes + R"(", "stop": "running = 0"}}})");
  folder.change("robots/r.json", R"({"place": {"type": "place"}})", "{" + parameters + "}");
  folder.change("robots/r.json", "{place.x}", data);
  folder.change("robots/r.json", R"("kind": "acknowledgement")", R"("kind": "state", "state": "state", "equals": 2)");
  if (!further.empty()) folder.change("robots/r.json", R"("skills")", further + R"(, "skills")");
  return without_keys(folder.check().faults);
}

std::string number(const std::string& name, const std::string& bounds) {
  return "\"" + name + R"(": {"type": "number", )" + bounds + "}";
}

}  // namespace

TEST_CASE("modbus: a bound that the register cannot hold is named with its parameter and the range") {
  const ConfigFaults far = faults_of(number("speed", R"("minimum": 0, "maximum": 100)"), "{speed}", "speed = {data}");
  REQUIRE_MESSAGE(far.size() == 1, to_text(far));
  CHECK(far[0].file == "commands.json");
  CHECK(far[0].key == "ur.commands.go");
  CHECK(far[0].what ==
        "writes 'speed', and \"maximum\" of parameter 'speed' of skill 'go' goes beyond it: 100 does not fit "
        "holding 0, a uint16");
  CHECK(far[0].hint == "give 0 to 65.535 as \"maximum\" in the description, or another type or factor to the value");
  CHECK(faults_of(number("speed", R"("minimum": -1, "maximum": 1)"), "{speed}", "speed = {data}").size() == 1);
  CHECK(faults_of(number("speed", R"("default": 70)"), "{speed}", "speed = {data}").size() == 1);
}

TEST_CASE("modbus: what fits, has no bound or goes elsewhere is no fault") {
  const std::string far = number("far", R"("minimum": 0, "maximum": 100)");
  for (const ConfigFaults& none :
       {faults_of(number("speed", R"("minimum": 0, "maximum": 65.535)"), "{speed}", "speed = {data}"),
        faults_of(number("speed", R"("unit": "m/s")"), "{speed}", "speed = {data}"),
        faults_of(far + ", " + number("speed", R"("maximum": 1)"), "[{far}, {speed}]", "jog = {0}\\nspeed = {1}")}) {
    CHECK_MESSAGE(none.empty(), to_text(none));
  }
}

TEST_CASE("modbus: each item of a list has its own register, in the robot's units") {
  const std::string two = number("a", R"("maximum": 1)") + ", " + number("b", R"("maximum": 100)");
  const ConfigFaults second = faults_of(two, "[{a}, {b}]", "jog = {0}\\nspeed = {1}");
  REQUIRE_MESSAGE(second.size() == 1, to_text(second));
  CHECK(second[0].what.find("parameter 'b'") != std::string::npos);
  const std::string list = R"("all": {"type": "numbers", "count": 2, "maximum": 100})";
  CHECK(faults_of(list, "{all}", "jog = {0}\\nspeed = {1}").size() == 1);
  const std::string metres = number("speed", R"("unit": "m/s", "maximum": 1)");
  CHECK(faults_of(metres, "{speed}", "speed = {data}", R"("frame": {"length_unit": "mm"})").size() == 1);
}

TEST_CASE("modbus: an end that the register never has is refused, as a fault's value is") {
  const NodeFolder folder("ur");
  folder.write("commands.json", R"({"ur": {"transport": "modbus", "values": {"running": "coil 0", "state": "input 0"},
    "commands": {"go": "running = 1", "stop": "running = 0"}}})");
  folder.change("robots/r.json", R"("kind": "acknowledgement")",
                R"("kind": "state", "state": "state", "equals": 70000, "fails_at": -1)");
  const ConfigFaults faults = without_keys(folder.check().faults);
  REQUIRE_MESSAGE(faults.size() == 2, to_text(faults));
  CHECK(faults[0].key == "ur.values.state");
  CHECK(faults[0].what.starts_with("is never 70000, for which skills.go.end.equals of the description waits"));
  CHECK(faults[1].hint == "give 0 to 65535");
}

TEST_CASE("modbus: data that the command can never take is a fault of the files, not of each run") {
  const std::string two = number("a", R"("maximum": 1)") + ", " + number("b", R"("maximum": 1)");
  const std::string three = two + ", " + number("c", R"("maximum": 1)");
  for (const auto& [parameters, data, writes, why] : std::vector<std::array<std::string, 4>>{
           {two, "{a} {b}", "jog = {0}\\nspeed = {1}", "the data is no JSON"},
           {number("a", R"("maximum": 1)"), "[{a}]", "jog = {0}\\nspeed = {1}", "speed takes {1}, which needs 2 items"},
           {number("a", R"("maximum": 1)"), "{a}", "jog = {5}", "jog takes {5}"},
           {three, "[{a}, {b}, {c}]", "jog = {0}\\nspeed = {1}", "takes 2 items, and the data has 3 items"},
           {R"("a": {"type": "text"})", "{a}", "jog = {data}", "the data holds a text"},
           {R"("a": {"type": "numbers", "count": 3})", "{a}", "jog = {0}\\nspeed = {1}", "has 3 items"}}) {
    const ConfigFaults faults = faults_of(parameters, data, writes);
    REQUIRE_MESSAGE(faults.size() == 1, to_text(faults));
    CHECK(faults[0].key == "ur.commands.go");
    CHECK_MESSAGE(faults[0].what.find(why) != std::string::npos, faults[0].what);
    CHECK(faults[0].hint.starts_with("write skills.go.command.data of the description as JSON"));
  }
  CHECK(faults_of(R"("a": {"type": "numbers"})", "{a}", "jog = {0}\\nspeed = {1}").empty());
  CHECK(faults_of(R"("a": {"type": "bool"})", "{a}", "running = {data}").empty());
}

TEST_CASE("modbus: an end between two numbers of the register, or a limit that it never passes, is refused") {
  for (const auto& [state, end, hint] : std::vector<std::array<std::string, 3>>{
           {"input 0", "2.5", "give 2 or 3"}, {"input 0 int16 * 0.1", "0.35", "give 0.3 or 0.4"}}) {
    const NodeFolder folder("ur");
    folder.write("commands.json", R"({"ur": {"transport": "modbus", "values": {"running": "coil 0", "state": ")" +
                                      state + R"("}, "commands": {"go": "running = 1", "stop": "running = 0"}}})");
    folder.change("robots/r.json", R"("kind": "acknowledgement")",
                  R"("kind": "state", "state": "state", "equals": )" + end);
    const ConfigFaults faults = without_keys(folder.check().faults);
    REQUIRE_MESSAGE(faults.size() == 1, to_text(faults));
    CHECK(faults[0].what.starts_with("is never " + end + ", for which skills.go.end.equals of the description waits"));
    CHECK(faults[0].hint == hint);
  }
  const std::string one = number("a", R"("maximum": 1)");
  const auto rule = [](const std::string& limit) {
    return R"("faults": {"hot": {"value": "state", )" + limit + R"(, "severity": "WARNING"}})";
  };
  const ConfigFaults never = faults_of(one, "{a}", "jog = {data}", rule(R"("above": 70000)"));
  REQUIRE_MESSAGE(never.size() == 1, to_text(never));
  CHECK(never[0].what ==
        "is never above 70000, for which faults.hot.above of the description waits: input 0 is 0 to 65535");
  CHECK(faults_of(one, "{a}", "jog = {data}", rule(R"("below": 0)")).size() == 1);
  CHECK(faults_of(one, "{a}", "jog = {data}", rule(R"("below": 1)")).empty());
}
