#include <doctest/doctest.h>

#include <limits>

#include "common/fleet/description.hpp"
#include "common/fleet/did_you_mean.hpp"
#include "common/fleet/places.hpp"

using namespace trb;

namespace {

template <class T>
struct FromFile {
  T is;
  ConfigFaults faults;
};

FromFile<Places> places_of(std::string_view text) {
  ConfigFaults faults;
  Places places = read_places(*parse_json(text), "places.json", faults);
  return {std::move(places), std::move(faults)};
}

FromFile<Description> description_of(std::string_view text) {
  ConfigFaults faults;
  Description description = read_description(*parse_json(text), "robots/r.json", faults);
  return {std::move(description), std::move(faults)};
}

}  // namespace

TEST_CASE("the nearest word is at most two edits away") {
  const std::vector<std::string> words = {"timeout_s", "end", "capability"};
  CHECK(nearest("timeout", words) == "timeout_s");
  CHECK(nearest("capabilty", words) == "capability");
  CHECK(nearest("ent", words) == "end");
  CHECK(nearest("fly", {"say"}).empty());
  CHECK(nearest("xy", words).empty());
  CHECK(nearest("", words).empty());
  CHECK(nearest(std::string(100'000, 'a'), words).empty());
  CHECK(nearest("retires", {"requires", "retries"}) == "retries");  // two letters exchanged are one slip
  CHECK(did_you_mean("speed", {}, "remove it") == "remove it");
  CHECK(did_you_mean("speed", words, "use one of") == "use one of: timeout_s, end, capability");
}

TEST_CASE("a long text is quoted short, and no character is cut in two") {
  const std::string text = std::string(63, 'a') + "é" + "bcd";
  CHECK(in_quotes(text) == "'" + std::string(63, 'a') + "…'");
  CHECK(in_quotes("short") == "'short'");
}

TEST_CASE("places: poses in the hall's frame") {
  const auto read = places_of(R"({"places": {"table1": {"x": 1, "y": 2.5, "yaw": 1.57}}})");
  CHECK(to_text(read.faults).empty());
  CHECK(read.is.at("table1") == Pose{1, 2.5, 0, 1.57});
}

TEST_CASE("places: every fault is told, with its key and a cure") {
  const auto read =
      places_of(R"({"places": {"Table": {"x": 1, "y": 2}, "a": {"x": "1"}, "b": {"x": 1, "y": 2, "jaw": 0},
                                  "c": 3, "d": {"x": 1e7, "y": 0}}, "place": 1})");
  REQUIRE(read.faults.size() == 7);
  CHECK(read.faults[0].key == "places.Table");
  CHECK(read.faults[1].key == "places.a.x");
  CHECK(read.faults[2].key == "places.a.y");
  CHECK(read.faults[3].key == "places.b.jaw");
  CHECK(read.faults[3].hint == "did you mean 'yaw'?");
  CHECK(read.faults[4].key == "places.c");
  CHECK(read.faults[5].key == "places.d.x");
  CHECK(read.faults[6].hint == "did you mean 'places'?");
  for (const ConfigFault& fault : read.faults) CHECK_FALSE(fault.hint.empty());
}

TEST_CASE("a document that is no object is one fault") {
  CHECK(places_of("[]").faults.size() == 1);
  CHECK(description_of("7").faults.size() == 1);
}

TEST_CASE("a whole description") {
  const auto read = description_of(R"({
    "maker": "ACME", "model": "Mover 2", "capabilities": ["mobile", "grab"],
    "frame": {"length_unit": "mm", "angle_unit": "deg", "origin": {"x": 1, "yaw": 0.5}},
    "places": {"dock": [1, 2], "shelf": 4},
    "field_channel": {"framing": "length", "encoding": "text", "acknowledge": false, "chunk_bytes": 80},
    "skills": {
      "go_to": {"capability": "mobile", "parameters": {"place": {"type": "place"}},
                "command": {"data": "{place.x} {place.y}"}, "end": {"kind": "acknowledgement"}, "timeout_s": 30,
                "repeatable": true},
      "lift": {"capability": "grab", "parameters": {"speed": {"type": "number", "unit": "m/s", "minimum": 0, "default": 0.1}},
               "command": {"subtype": "raise", "data": "{speed}"}, "end": {"kind": "state", "state": "lift", "equals": 1}}}})");
  REQUIRE(to_text(read.faults) == "");
  const Description& d = read.is;
  CHECK(d.maker == "ACME");
  CHECK(d.frame.length == 1000);
  CHECK(d.frame.angle == doctest::Approx(57.2957795));
  CHECK(d.frame.origin == Pose{1, 0, 0, 0.5});
  CHECK(d.places.at("shelf").integer() == 4);
  CHECK(d.has_field_channel);
  CHECK(d.field_channel.framing == Framing::length);
  CHECK(d.field_channel.chunk_bytes == 80);
  CHECK_FALSE(d.field_channel.acknowledge);
  REQUIRE(d.skills.size() == 2);
  CHECK(d.find_skill("go_to")->subtype == "go_to");
  CHECK(d.find_skill("go_to")->repeatable);
  CHECK(d.find_skill("lift")->subtype == "raise");
  CHECK_FALSE(d.find_skill("lift")->parameters[0].required);
  CHECK(d.find_skill("lift")->end.state == "lift");
  CHECK(d.find_skill("fly") == nullptr);
  const auto infos = skill_infos(d);
  REQUIRE(infos.size() == 2);
  CHECK(infos[0].parameters[0] == ParameterInfo{"place", "place", true, ""});
  constexpr double kOpen = std::numeric_limits<double>::max();
  CHECK(infos[1].parameters[0] == ParameterInfo{"speed", "number", false, "m/s", {0, kOpen}});
  CHECK(infos[0].timeout_s == 30);
  CHECK(place_names(d, {{"dock", {}}, {"table1", {}}}) == std::vector<std::string>{"dock", "shelf", "table1"});
}

TEST_CASE("a parameter's range, words and count are told to the fleet") {
  const auto read =
      description_of(R"({"maker": "A", "model": "B", "capabilities": ["c"], "skills": {"s": {"capability": "c",
    "parameters": {"joints": {"type": "numbers", "count": 6, "maximum": 2}, "side": {"type": "text", "one_of": ["a", "b"]}},
    "end": {"kind": "acknowledgement"}}}})");
  const auto infos = skill_infos(read.is);
  REQUIRE(infos.size() == 1);
  CHECK(infos[0].parameters[0].range == std::vector<double>{-std::numeric_limits<double>::max(), 2});
  CHECK(infos[0].parameters[0].count == 6);
  CHECK(infos[0].parameters[1].one_of == std::vector<std::string>{"a", "b"});
}

TEST_CASE("where an object belongs, the cure names the keys that it may have") {
  const auto read =
      description_of(R"({"maker": "A", "model": "B", "capabilities": [], "skills": {}, "numbers": {"reach": 0.85}})");
  REQUIRE(read.faults.size() == 1);
  CHECK(read.faults[0].key == "numbers.reach");
  CHECK(read.faults[0].hint.find(R"({ "value": …, "unit": … })") != std::string::npos);
}

TEST_CASE("numbers of the robot are told with their units") {
  const auto head = std::string(R"({"maker": "A", "model": "B", "capabilities": [], "skills": {}, "numbers": )");
  const auto read = description_of(head + R"({"payload": {"value": 3, "unit": "kg"}, "axes": {"value": 6}}})");
  CHECK(read.faults.empty());
  CHECK(read.is.numbers == std::vector<NamedNumber>{{"payload", 3, "kg"}, {"axes", 6, ""}});
  const auto wrong = description_of(
      head + R"({"pay load": {"value": 3}, "reach": {"unit": "m"}, "mass": {"value": "3", "unti": "kg"}}})");
  const std::string text = to_text(wrong.faults);
  for (const char* expected : {"'pay load' is no name", "numbers.reach.value: is missing",
                               "numbers.mass.value: is a text", "numbers.mass.unti: is no key"}) {
    CAPTURE(expected);
    CHECK_MESSAGE(text.find(expected) != std::string::npos, text);
  }
}

TEST_CASE("a description: faults of its own keys") {
  const auto read = description_of(R"({"model": 5, "capabilities": ["mobile", "mobile", 3], "skils": {},
    "frame": {"length_unit": "cm"}, "field_channel": {"framing": "newlin", "chunk_bytes": 1, "ack_timeout_s": 0}})");
  const std::string text = to_text(read.faults);
  for (const char* expected :
       {"robots/r.json: maker: is missing", "model: is a whole number", "capabilities[1]: 'mobile' occurs twice",
        "capabilities[2]: is a whole number", "skills: is missing", "skils: is no key", "did you mean 'skills'?",
        "frame.length_unit: 'cm' is not known here; use one of: m, mm", "did you mean 'newline'?",
        "field_channel.chunk_bytes: 1 is too small", "field_channel.ack_timeout_s: 0 is out of range"}) {
    CAPTURE(expected);
    CHECK_MESSAGE(text.find(expected) != std::string::npos, text);
  }
  CHECK(read.faults.size() == 10);
  for (const ConfigFault& fault : read.faults) CHECK_FALSE(fault.hint.empty());
}

TEST_CASE("the numeric encoding: every word needs a number of its own, and data are numbers") {
  const auto read = description_of(R"({"maker": "m", "model": "n", "capabilities": ["grab"],
    "field_channel": {"encoding": "numeric", "codes": {"subtypes": {"done": 1, "pick": 1, "failed": 0}}},
    "skills": {
      "pick": {"capability": "grab", "command": {"data": "now"}, "end": {"kind": "acknowledgement"}},
      "name": {"capability": "grab", "parameters": {"as": {"type": "text"}}, "command": {"data": "{as}"},
               "end": {"kind": "acknowledgement"}}}})");
  const std::string text = to_text(read.faults);
  for (const char* expected :
       {"codes.subtypes.pick: 1 is already the number of 'done'", "codes.subtypes.failed: 0 is out of range",
        "codes.subtypes.failed: the numeric encoding has no number", "codes.subtypes.name: the numeric encoding",
        "skills.pick.command.data: the numeric", "skills.name.command.data: the numeric"}) {
    CAPTURE(expected);
    CHECK_MESSAGE(text.find(expected) != std::string::npos, text);
  }
  CHECK(read.faults.size() == 6);
}
