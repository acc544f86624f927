#include "services/mode-adapter/core/skill_call.hpp"

#include <doctest/doctest.h>

#include <cmath>

#include "services/mode-adapter/test/fixture.hpp"

using namespace trb;
using namespace trb::adapter;

namespace {

Parameter speed() {
  Parameter parameter = make_parameter("speed", ParameterType::number, "m/s");
  parameter.minimum = 0;
  parameter.maximum = 1.5;
  return parameter;
}

struct Call {
  Skill skill;
  Description description;
  Places places{{"dock", {3, 2, 1, M_PI}}};

  std::string with(const std::string& parameters, CallStyle style = CallStyle::words) const {
    const auto call = render_call(skill, parameters, description, places, style);
    return call ? call->data : call.error().text();
  }
};

bool says(const std::string& text, const char* part) {
  return text.find(part) != std::string::npos;
}

}  // namespace

TEST_CASE("parameters are checked, and the fault names the one that is wrong") {
  Parameter side = make_parameter("side", ParameterType::text);
  side.one_of = {"left", "right"};
  Parameter joints = make_parameter("joints", ParameterType::numbers);
  joints.count = 2;
  Parameter times = make_parameter("times", ParameterType::integer);
  times.required = false;
  times.preset = Value{std::int64_t{1}};
  const Call call{make_skill("s", "{speed} {side} {joints} {times}", {speed(), side, joints, times}), {}, {}};
  CHECK(call.with(R"({"speed": 1, "side": "left", "joints": [1, 2.5]})") == "1 left 1 2.5 1");
  CHECK(call.with(R"({"speed": 1, "side": "left", "joints": [1, 2], "times": 2.0})") == "1 left 1 2 2");
  CHECK(says(call.with("[]"), "not an object"));
  CHECK(says(call.with("{"), "malformed"));
  CHECK(says(call.with(R"({"side": "left", "joints": [1, 2]})"), "'speed': is required"));
  CHECK(says(call.with(R"({"spede": 1})"), "'spede'"));
  CHECK(says(call.with(R"({"speed": 3, "side": "left", "joints": [1, 2]})"), "'speed': 3 is over 1.5 m/s"));
  CHECK(says(call.with(R"({"speed": -1, "side": "left", "joints": [1, 2]})"), "'speed': -1 is under 0"));
  CHECK(says(call.with(R"({"speed": "fast", "side": "left", "joints": [1, 2]})"), "'speed': is a text"));
  CHECK(says(call.with(R"({"speed": 1, "side": "up", "joints": [1, 2]})"), "use one of: left, right"));
  CHECK(says(call.with(R"({"speed": 1, "side": "left", "joints": [1]})"), "'joints': has 1 numbers, not 2"));
  CHECK(says(call.with(R"({"speed": 1, "side": "left", "joints": [1, "a"]})"), "'joints': holds a text"));
  CHECK(says(call.with(R"({"speed": 1, "side": "left", "joints": [1, 2], "times": 1.5})"), "no whole number"));
}

TEST_CASE("a place: the hall's pose from the robot's origin, in its direction and units") {
  Call call{make_skill("s", "{p.x} {p.y} {p.z} {p.yaw}", {make_parameter("p", ParameterType::place)}), {}};
  CHECK(call.with(R"({"p": "dock"})") == "3 2 1 3.141592654");
  call.description.frame.length = 1000;
  call.description.frame.angle = 180 / M_PI;
  call.description.frame.origin = {1, 1, 1, M_PI / 2};
  CHECK(call.with(R"({"p": "dock"})") == "1000 -2000 0 90");
  CHECK(says(call.with(R"({"p": "moon"})"), "unknown_place: parameter 'p'"));
  call.skill.data = "{p.qz} {p.qw}";  // a quarter turn, whatever the robot's unit
  CHECK(call.with(R"({"p": "dock"})") == "0.7071067812 0.7071067812");
}

TEST_CASE("the robot's own words for a place win; a place without any is called by its name") {
  Call call{make_skill("s", "{p}", {make_parameter("p", ParameterType::place)}), {}};
  CHECK(call.with(R"({"p": "dock"})") == "dock");
  call.description.places["dock"] = Value{Value::List{Value{0.25}, Value{std::int64_t{-1}}}};
  CHECK(call.with(R"({"p": "dock"})") == "0.25 -1");
  CHECK(call.with(R"({"p": "dock"})", CallStyle::json) == "[0.25,-1]");
  call.description.places["shelf"] = Value{std::int64_t{7}};
  CHECK(call.with(R"({"p": "shelf"})") == "7");
  call.skill.data = "{p.x}";
  CHECK(says(call.with(R"({"p": "shelf"})"), "unknown_place"));
}

TEST_CASE("SI units become the vendor's by the parameter's unit") {
  Call call{make_skill("s", "{speed} {turn}", {speed(), make_parameter("turn", ParameterType::numbers, "rad")}), {}};
  call.description.frame.length = 1000;
  call.description.frame.angle = 2;
  CHECK(call.with(R"({"speed": 0.5, "turn": [1, 0.25]})") == "500 2 0.5");
}

TEST_CASE("the same values as words, as bare numbers and as JSON") {
  const Call call{make_skill("s", "{on} {word} {list}",
                             {make_parameter("on", ParameterType::boolean), make_parameter("word", ParameterType::text),
                              make_parameter("list", ParameterType::numbers)}),
                  {},
                  {}};
  const std::string given = R"({"on": true, "word": "a\"b", "list": [1, 2]})";
  CHECK(call.with(given) == "true a\"b 1 2");
  CHECK(call.with(given, CallStyle::numbers) == "1 a\"b 1 2");
  CHECK(call.with(given, CallStyle::json) == R"(true "a\"b" [1,2])");
}
