#include <doctest/doctest.h>

#include "common/fleet/description.hpp"

using namespace trb;

namespace {

ConfigFaults faults_of(const std::string& skills) {
  const std::string text = R"({"maker":"m","model":"n","capabilities":["mobile","grab"],"skills":)" + skills + "}";
  const auto json = parse_json(text);
  REQUIRE_MESSAGE(json.ok(), text);
  ConfigFaults faults;
  read_description(*json, "r.json", faults);
  return faults;
}

/// The one fault of a skill `go` with these keys.
ConfigFault skill_fault(const std::string& keys) {
  const ConfigFaults faults = faults_of(R"({"go": {)" + keys + "}}");
  REQUIRE_MESSAGE(faults.size() == 1, (keys + "\n" + to_text(faults)));
  CHECK_FALSE(faults[0].hint.empty());
  CHECK(faults[0].file == "r.json");
  return faults[0];
}

const std::string kMobile = R"("capability": "mobile", )";
const std::string kEnd = R"("end": {"kind": "acknowledgement"})";

std::string with_parameter(const std::string& keys) {
  return kMobile + kEnd + R"(, "parameters": {"p": {)" + keys + "}}";
}

}  // namespace

TEST_CASE("a skill without an end is refused, and told what an end is") {
  const ConfigFault fault = skill_fault(R"("capability": "mobile")");
  CHECK(fault.key == "skills.go.end");
  CHECK(fault.what == "the skill has no end");
  for (const char* kind : {"acknowledgement", "state", "position", "time"})
    CHECK(fault.hint.find(kind) != std::string::npos);
}

TEST_CASE("ends: what each kind needs") {
  const std::string place = kMobile + R"("parameters": {"at": {"type": "place"}, "n": {"type": "number"}}, )";
  const std::vector<std::pair<std::string, std::string>> cases = {
      {R"({"kind": "when_ready"})", "skills.go.end.kind"},
      {R"({"kind": "state", "equals": 1})", "skills.go.end.state"},
      {R"({"kind": "state", "state": "s"})", "skills.go.end.equals"},
      {R"({"kind": "state", "state": "s", "equals": "on"})", "skills.go.end.equals"},
      {R"({"kind": "position"})", "skills.go.end.target"},
      {R"({"kind": "position", "target": "att"})", "skills.go.end.target"},
      {R"({"kind": "position", "target": "n"})", "skills.go.end.target"},
      {R"({"kind": "position", "target": "at", "tolerance": 0})", "skills.go.end.tolerance"},
      {R"({"kind": "time"})", "skills.go.end.duration_s"},
      {R"({"kind": "time", "duration_s": 0})", "skills.go.end.duration_s"},
      {R"({"kind": "time", "duration_s": 60})", "skills.go.end.duration_s"},
      {R"({"kind": "time", "duration_s": 1, "equals": 1})", "skills.go.end.equals"}};
  for (const auto& [end, key] : cases) {
    const std::string given = end;
    CAPTURE(given);
    CHECK(skill_fault(place + R"("end": )" + end).key == key);
  }
  CHECK(faults_of(R"({"go": {"capability": "mobile", "end": "acknowledgement"}})").front().key == "skills.go.end");
  CHECK(
      faults_of("{\"go\": {" + place + R"("end": {"kind": "position", "target": "at", "tolerance": 0.05}}})").empty());
}

TEST_CASE("skills: names, capabilities, times and keys") {
  CHECK(skill_fault(R"("capability": "mobil", )" + kEnd).hint == "did you mean 'mobile'?");
  CHECK(skill_fault(R"("capability": "fly", )" + kEnd).hint.find("mobile, grab") != std::string::npos);
  CHECK(skill_fault(kEnd).key == "skills.go.capability");
  CHECK(skill_fault(kMobile + kEnd + R"(, "timeout_s": 0)").key == "skills.go.timeout_s");
  CHECK(skill_fault(kMobile + kEnd + R"(, "timeout_s": 1e9)").key == "skills.go.timeout_s");
  CHECK(skill_fault(kMobile + kEnd + R"(, "timeout_s": "60")").key == "skills.go.timeout_s");
  CHECK(skill_fault(kMobile + kEnd + R"(, "repeatable": 1)").key == "skills.go.repeatable");
  CHECK(skill_fault(kMobile + kEnd + R"(, "timeout": 3)").hint == "did you mean 'timeout_s'?");
  CHECK(skill_fault(kMobile + kEnd + R"(, "command": {"subtype": "go to"})").key == "skills.go.command.subtype");
  CHECK(skill_fault(kMobile + kEnd + R"(, "command": {"subtype": "stop"})").what.find("is no skill") !=
        std::string::npos);
  CHECK(faults_of(R"({"go to": {"capability": "mobile", "end": {"kind": "acknowledgement"}}})").size() >= 1);
  CHECK(faults_of(R"({"go": 3})").size() == 1);
}

TEST_CASE("data: placeholders name parameters") {
  const std::string start =
      kMobile + kEnd + R"(, "parameters": {"place": {"type": "place"}, "speed": {"type": "number"},
    "note": {"type": "text", "required": false}}, "command": {"data": )";
  CHECK(skill_fault(start + R"("{plase.x}"})").hint == "did you mean 'place'?");
  CHECK(skill_fault(start + R"("{place.w}"})").hint == "use one of: x, y, z, yaw, qz, qw");
  CHECK(skill_fault(start + R"("{speed.x}"})").hint == "use {speed}");
  CHECK(skill_fault(start + R"("{note}"})").hint.find("default") != std::string::npos);
  for (const char* broken : {R"("{place"})", R"("place}"})", R"("{}"})", R"("{place.}"})", R"("{{place}}"})"}) {
    CAPTURE(broken);
    const ConfigFaults faults = faults_of("{\"go\": {" + start + broken + "}}");
    REQUIRE_FALSE(faults.empty());
    CHECK(faults[0].key == "skills.go.command.data");
  }
  CHECK(faults_of("{\"go\": {" + start + R"("{place.x} {place.yaw} {place.qz} {place.qw} at {speed}"}}})").empty());
}

TEST_CASE("parameters: types, bounds and defaults") {
  const std::vector<std::pair<std::string, std::string>> cases = {
      {R"("unit": "m")", "type"},
      {R"("type": "float")", "type"},
      {R"("type": "number", "unit": "mm")", "unit"},
      {R"("type": "number", "minimum": 3, "maximum": 1)", "minimum"},
      {R"("type": "number", "one_of": ["a"])", "one_of"},
      {R"("type": "text", "minimum": 1)", "minimum"},
      {R"("type": "text", "one_of": ["a", "a"])", "one_of[1]"},
      {R"("type": "text", "one_of": ["a"], "default": "b")", "default"},
      {R"("type": "number", "required": true, "default": 1)", "default"},
      {R"("type": "number", "maximum": 1, "default": 2)", "default"},
      {R"("type": "integer", "default": 1.5)", "default"},
      {R"("type": "bool", "default": 1)", "default"},
      {R"("type": "numbers", "count": 0)", "count"},
      {R"("type": "numbers", "count": 2, "default": [1])", "default"},
      {R"("type": "numbers", "maximum": 3, "default": [1, 4])", "default"}};
  for (const auto& [keys, key] : cases) {
    const std::string given = keys;
    CAPTURE(given);
    const ConfigFaults faults = faults_of("{\"go\": {" + with_parameter(keys) + "}}");
    REQUIRE_MESSAGE(faults.size() == 1, to_text(faults));
    CHECK(faults[0].key == "skills.go.parameters.p." + key);
  }
  for (const char* good :
       {R"("type": "numbers", "count": 2, "default": [1, 2.5])", R"("type": "bool", "default": false)",
        R"("type": "place", "one_of": ["left", "right"], "default": "left")",
        R"("type": "integer", "minimum": 0, "maximum": 3, "default": 3)"}) {
    CAPTURE(good);
    CHECK(to_text(faults_of("{\"go\": {" + with_parameter(good) + "}}")) == "");
  }
}
