// The notation of the transport modbus: what it allows, how numbers lie in registers, and every mistake by its hint.
#include "common/drivers/modbus/syntax.hpp"

#include <doctest/doctest.h>

#include <cmath>
#include <tuple>

#include "tests/support/node_folder.hpp"

using namespace trb;
using namespace trb::drivers;

namespace {

using Registers = std::vector<std::uint16_t>;

ModbusPlace place(const std::string& text) {
  const auto read = read_modbus_place(text);
  REQUIRE_MESSAGE(read.ok(), text);
  return *read;
}

std::string fault_of(const std::string& text) {
  const auto read = read_modbus_place(text);
  return read ? "none" : read.error().text();
}

std::string line_fault(const std::string& text) {
  const ModbusPlaces values = {
      {"running", place("coil 0")}, {"speed", place("holding 0 uint16 * 0.001")}, {"at_exit", place("discrete 0")}};
  const auto read = read_modbus_assignments(text, values);
  return read ? "none" : read.error().text();
}

constexpr const char* kConveyor = R"({"ur": {"transport": "modbus", "unit": 3, "poll_s": 0.05,
  "values": {"running": "coil 0", "at_exit": "discrete 0", "speed": "holding 0 uint16 * 0.001"},
  "commands": {"go": "speed = 0.5\nrunning = true", "set_speed": "speed = {data}", "stop": "running = 0", "release": ""},
  "requests": {"speed": "speed"}}})";

struct Conveyor : NodeFolder {
  Conveyor() : NodeFolder("ur") {
    write("commands.json", kConveyor);
    change("robots/r.json", R"("kind": "acknowledgement")", R"("kind": "state", "state": "at_exit", "equals": 1)");
  }
};

}  // namespace

TEST_CASE("modbus words: a place is a kind, an address, a type, the order of two words, a factor and an offset") {
  CHECK(place("coil 7").type == ModbusType::boolean);
  CHECK(place("input 65535").type == ModbusType::uint16);
  const ModbusPlace full = place("  holding  4 float32 low_word_first * 0.1 - 40 ");
  CHECK(full.kind == ModbusKind::holding);
  CHECK(full.address == 4);
  CHECK(full.type == ModbusType::float32);
  CHECK(full.low_word_first);
  CHECK(full.factor == 0.1);
  CHECK(full.offset == -40);
  CHECK(place("input 2 * 2 + 1").offset == 1);
  CHECK(place("input 2 + 1").factor == 1);
  CHECK(place("discrete 1 bool").size() == 1);
  CHECK(place("holding 65534 int32").size() == 2);
}

TEST_CASE("modbus words: what is wrong with a place is named with its cure") {
  const std::vector<std::pair<std::string, std::string>> cases = {
      {"", "'' is no kind of register"},
      {"coils 1", "did you mean 'coil'?"},
      {"register 1", "use one of: coil, discrete, input, holding"},
      {"coil", "is no address"},
      {"coil x", "'x' is no address"},
      {"coil -1", "outside 0 to 65535"},
      {"holding 65536", "a manual's 40001 is holding 0"},
      {"holding 99999999999999999999", "no address"},
      {"holding 1 int61", "did you mean 'int16'?"},
      {"coil 1 int16", "holds one bit"},
      {"coil 1 * 2", "a bool has no factor"},
      {"holding 1 int16 low_word_first", "has one word only"},
      {"holding 1 * 0", "'0' is no factor"},
      {"holding 1 * nan", "'nan' is no factor"},
      {"holding 1 *", "'' is no factor"},
      {"holding 1 + x", "'x' is no offset"},
      {"holding 1 uint16 *0.1", "left over"},
      {"holding 1 uint16 * 2 + 1 3", "'3' is left over"},
      {"holding 65535 float32", "takes two registers"},
  };
  for (const auto& [text, fault] : cases) {
    const std::string found = fault_of(text);
    CHECK_MESSAGE(found.find(fault) != std::string::npos, found);
  }
}

TEST_CASE("modbus numbers: every type lies in its registers as the device has it, and comes back") {
  const std::vector<std::tuple<std::string, double, Registers>> cases = {
      {"coil 0", 1, {1}},
      {"holding 0 int16", -2, {0xfffe}},
      {"holding 0", 65535, {0xffff}},
      {"holding 0 int32", -2, {0xffff, 0xfffe}},
      {"holding 0 uint32", 4294967295.0, {0xffff, 0xffff}},
      {"holding 0 uint32", 65536, {1, 0}},
      {"holding 0 uint32 low_word_first", 65536, {0, 1}},
      {"holding 0 float32", 1.5, {0x3fc0, 0}},
      {"holding 0 float32 low_word_first", 0.1, {0xcccd, 0x3dcc}},
      {"holding 0 uint16 * 0.001", 0.25, {250}},
      {"holding 0 int16 * 0.1 - 40", -40.5, {0xfffb}},
      {"holding 0 * -1", -7, {7}},
  };
  for (const auto& [text, number, registers] : cases) {
    const std::string written = text;
    CAPTURE(written);
    const auto words = modbus_words(place(text), number);
    REQUIRE(words.ok());
    CHECK(*words == registers);
    const auto back = modbus_number(place(text), registers);
    REQUIRE(back.ok());
    CHECK(std::abs(*back - number) < 1e-9);
  }
  CHECK(modbus_number(place("holding 0 float32"), {0x3dcc, 0xcccd}).value() == 0.1);
  CHECK(modbus_number(place("input 0 float32"), {0x7fc0, 0}).error().hint.find("low_word_first") != std::string::npos);
  CHECK_FALSE(modbus_number(place("input 0 float32"), {1}).ok());
}

TEST_CASE("modbus numbers: what a register cannot hold is refused with the range that it has") {
  const auto hint = [](const std::string& text, double number) { return modbus_words(place(text), number).error(); };
  CHECK(hint("holding 0 uint16 * 0.001", 70).hint == "give 0 to 65.535");
  CHECK(hint("holding 0 int16 * 0.1 - 40", 4000).hint == "give -3316.8 to 3236.7");
  CHECK(hint("holding 0", -1).what == "-1 does not fit holding 0, a uint16");
  CHECK(hint("holding 0", 0.5).hint.find("factor") != std::string::npos);
  CHECK(hint("coil 3", 2).hint == "give true, false, 1 or 0");
  CHECK(hint("coil 3", 0.5).hint == "give true, false, 1 or 0");
  CHECK(hint("holding 0 float32", 1e300).code == Errc::bad_value);
  CHECK(hint("holding 0 int32", std::nan("")).code == Errc::bad_value);
  CHECK(modbus_words(place("holding 0 * 0.001"), 0.2504).value() == Registers{250});  // to the nearest possible one
}

TEST_CASE("modbus words: a command is assignments, each to a name or a place") {
  const ModbusPlaces values = {{"speed", place("holding 0 uint16 * 0.001")}};
  const auto read =
      read_modbus_assignments("speed = {0}\n\n  coil 5=true \nholding 3 int16 = {data}\r\nspeed = 0.25", values);
  REQUIRE(read.ok());
  REQUIRE(read->size() == 4);
  CHECK((*read)[0].item == 0);
  CHECK((*read)[1].place.address == 5);
  CHECK((*read)[1].literal == 1);
  CHECK((*read)[2].item == ModbusAssignment::kWhole);
  CHECK((*read)[2].name == "holding 3 int16");
  CHECK((*read)[3].literal == 0.25);
}

TEST_CASE("modbus words: what is wrong with an assignment is named with its cure") {
  const std::vector<std::pair<std::string, std::string>> cases = {
      {"running", "write NAME = NUMBER"},
      {"runing = 1", "did you mean 'running'?"},
      {"coil x = 1", "'x' is no address"},
      {"at_exit = 1", "'at_exit' (discrete 0) cannot be written"},
      {"input 3 = 1", "cannot be written"},
      {"running = on", "'on' is nothing that can be written"},
      {"running = {x}", "'{x}' is nothing that can be written"},
      {"running = {100}", "nothing that can be written"},
      {"running = 2", "running: 2 does not fit coil 0"},
      {"speed = 70", "give 0 to 65.535"},
      {"running = ", "nothing that can be written"},
  };
  for (const auto& [text, fault] : cases) {
    const std::string found = line_fault(text);
    CHECK_MESSAGE(found.find(fault) != std::string::npos, found);
  }
  std::string many;
  for (int i = 0; i < 65; ++i) many += "running = 1\n";
  CHECK(line_fault(many).find("more than 64") != std::string::npos);
}

TEST_CASE("modbus: a conveyor's folder is good, and its settings are read") {
  const NodeCheck check = Conveyor().check();
  CHECK_MESSAGE(without_keys(check.faults).empty(), to_text(check.faults));
  CHECK(modbus_settings(check.config.commands).unit == 3);
  CHECK(modbus_settings(check.config.commands).poll_s == 0.05);
  CHECK(modbus_settings(check.config.commands).timeout_s == 0.5);
}

TEST_CASE("modbus: a fault that waits for what a coil or a register never is") {
  const auto faults_of = [](const std::string& value, const std::string& wanted) {
    const Conveyor folder;
    folder.change("robots/r.json", R"("skills")",
                  R"("faults": {"f": {"value": ")" + value + R"(", "equals": )" + wanted +
                      R"(, "severity": "CRITICAL"}}, "skills")");
    return without_keys(folder.check().faults);
  };
  const ConfigFaults coil = faults_of("running", "\"true\"");
  REQUIRE(coil.size() == 1);
  CHECK(coil[0].key == "ur.values.running");
  CHECK(coil[0].what ==
        "is never \"true\", for which faults.f.equals of the description waits: coil 0 is true or false");
  CHECK(coil[0].hint == "write true or false there, without quotes");
  const ConfigFaults text = faults_of("speed", "\"three\"");
  REQUIRE(text.size() == 1);
  CHECK(text[0].hint == "write a number there, without quotes");
  const ConfigFaults far = faults_of("speed", "100");
  REQUIRE(far.size() == 1);
  CHECK(far[0].hint == "give 0 to 65.535");
  CHECK(faults_of("running", "2").size() == 1);
  CHECK(faults_of("speed", "0.0005").size() == 1);  // between two numbers of the register
  for (const auto& [value, wanted] : std::vector<std::pair<std::string, std::string>>{
           {"running", "true"}, {"running", "0"}, {"speed", "65.535"}, {"speed", "0.005"}, {"speed", "true"}}) {
    CAPTURE(wanted);
    const ConfigFaults none = faults_of(value, wanted);
    CHECK_MESSAGE(none.empty(), to_text(none));
  }
}

TEST_CASE("modbus: each mistake in commands.json is one fault, with its key") {
  struct Change {
    std::string from, to, key, what;
  };
  const std::vector<Change> changes = {
      {"\"coil 0\"", "\"coyl 0\"", "ur.values.running", "no kind of register"},
      {"\"coil 0\"", "\"coil 70000\"", "ur.values.running", "outside 0 to 65535"},
      {"\"unit\": 3", "\"unit\": 250", "ur.unit", "250 is no unit"},
      {"\"unit\": 3", "\"unit\": 256", "ur.unit", "256"},
      {"\"poll_s\": 0.05", "\"poll_s\": 0", "ur.poll_s", "0"},
      {"\"poll_s\": 0.05", "\"timeout_s\": 60", "ur.timeout_s", "60"},
      {"\"unit\": 3", "\"units\": 3", "ur.units", "no key"},
      {"\"unit\": 3", "\"language\": \"urscript\"", "ur.language", "no part of modbus"},
      {"running = true", "runing = true", "ur.commands.go", "'runing'"},
      {"speed = 0.5", "speed = 500", "ur.commands.go", "500 does not fit"},
      {"speed = 0.5", "at_exit = 1", "ur.commands.go", "cannot be written"},
      {"\"stop\": \"running = 0\", ", "", "ur.commands.stop", "is missing"},
      {"\"stop\": \"running = 0\"", "\"stop\": \"running = {0}\"", "ur.commands.stop", "a stop has none"},
      {"\"set_speed\": \"speed = {data}\"", "\"set_speed\": \"\"", "ur.commands.set_speed", "has no words"},
      {"\"speed\": \"speed\"", "\"speed\": \"sped\"", "ur.requests.speed", "'sped'"},
      {"\"at_exit\": \"discrete 0\", ", "", "ur.values.at_exit", "end of skill 'go'"},
      {"\"go\": \"speed = 0.5\\nrunning = true\", ", "", "ur.commands.go", "skill 'go' sends it"},
      {"\"transport\": \"modbus\", ", "\"transport\": \"tcp-text\", \"port\": 1, ", "ur.unit", "no key"},
  };
  for (const Change& one : changes) {
    CAPTURE(one.to);
    const Conveyor folder;
    folder.change("commands.json", one.from, one.to);
    const ConfigFaults faults = without_keys(folder.check().faults);
    REQUIRE_MESSAGE(!faults.empty(), one.to);
    const ConfigFault& fault = faults[0];
    CHECK(fault.file == "commands.json");
    CHECK(fault.key == one.key);
    CHECK_MESSAGE(fault.what.find(one.what) != std::string::npos, fault.what);
    CHECK_FALSE(fault.hint.empty());
    if (one.key != "ur.unit" || one.to.find("tcp-text") == std::string::npos)
      CHECK_MESSAGE(faults.size() == 1, to_text(faults));
  }
}
