// ROS messages between JSON and the wire: every kind of field, flat lists, and errors that name the field.
#include "services/ros-bridge/core/message_codec.hpp"

#include <doctest/doctest.h>

#include "common/base/hex.hpp"

using namespace trb;
using namespace trb::ros;

namespace {

RosTypePtr type_of(const std::string& text) {
  TypeStore store([&](const std::string& type) -> Result<std::string> {
    if (type == "demo/Main") return text;
    if (type == "demo/Point") return std::string("float64 x\nfloat64 y\n");
    if (type == "demo/Nothing") return std::string();
    return fail(Errc::missing, type);
  });
  return *store.find("demo/Main");
}

std::string wire_of(const std::string& text, std::string_view json) {
  const auto wire = to_wire(*type_of(text), *parse_json(json));
  return wire ? to_hex(*wire) : wire.error().text();
}

std::string json_of(const std::string& text, std::string_view hex) {
  const auto json = to_json(*type_of(text), *from_hex(hex));
  return json ? dump_json(*json) : json.error().text();
}

}  // namespace

TEST_CASE("every kind of field has its bytes, and comes back") {
  const auto both = [](const std::string& text, std::string_view json, std::string_view hex) {
    CAPTURE(text);
    CHECK(wire_of(text, json) == hex);
    CHECK(json_of(text, hex) == json);
  };
  both("bool a", R"({"a":true})", "01");
  both("byte a", R"({"a":-1})", "ff");
  both("char a", R"({"a":255})", "ff");
  both("int16 a", R"({"a":-2})", "feff");
  both("uint16 a", R"({"a":65535})", "ffff");
  both("int32 a", R"({"a":-2147483648})", "00000080");
  both("uint32 a", R"({"a":4294967295})", "ffffffff");
  both("int64 a", R"({"a":-9223372036854775808})", "0000000000000080");
  both("uint64 a", R"({"a":"18446744073709551615"})", "ffffffffffffffff");
  both("float32 a", R"({"a":0.5})", "0000003f");
  both("float64 a", R"({"a":-0.0})", "0000000000000080");
  both("string a", R"({"a":"hé"})", "0300000068c3a9");
  both("string a", R"({"a":{"base64":"/w=="}})", "01000000ff");
  both("time a", R"({"a":{"secs":1,"nsecs":2}})", "0100000002000000");
  both("duration a", R"({"a":{"secs":-1,"nsecs":2}})", "ffffffff02000000");
  both("int16[] a", R"({"a":[1,2]})", "0200000001000200");
  both("int16[2] a", R"({"a":[1,2]})", "01000200");
  both("uint8[] a", R"({"a":"AQL/"})", "030000000102ff");
  both("uint8[3] a", R"({"a":"AQL/"})", "0102ff");
  both("string[] a", R"({"a":["","b"]})", "02000000000000000100000062");
  both("Point[1] a", R"({"a":[{"x":0.0,"y":0.0}]})", std::string(32, '0'));
  both("Nothing[] a\nint8 b", R"({"a":[{},{}],"b":7})", "0200000007");
}

TEST_CASE("a number that is not finite is not measured when heard, and refused by its field when told") {
  CHECK(json_of("float32 a\nfloat64 b",
                "0000c07f"
                "000000000000f0ff") == R"({"a":null,"b":null})");
  CHECK(json_of("Point[] a",
                "01000000"
                "000000000000f87f"
                "0000000000000040") == R"({"a":[{"x":null,"y":2.0}]})");
  for (const char* word : {"nan", "NaN", "inf", "-inf", "Infinity", "-Infinity"}) {
    CAPTURE(word);
    CHECK(wire_of("Point a", R"({"a":{"y":")" + std::string(word) + R"("}})") ==
          "bad_value: a.y: '" + std::string(word) +
              "' is no number that a robot can follow; send a finite number, or leave the field out: it is then 0");
    CHECK(wire_of("Point a", "[0,\"" + std::string(word) + "\"]").starts_with("bad_value: a.y: '"));
  }
  CHECK(wire_of("float64 a", R"({"a":null})").starts_with("bad_value: a: "));
}

TEST_CASE("what is left out is zero") {
  CHECK(wire_of("int8 a\nstring b\ntime c\nPoint d\nint8[] e\nint8[2] f\nbool g", "{}") ==
        "00"
        "00000000"
        "0000000000000000"
        "00000000000000000000000000000000"
        "00000000"
        "0000"
        "00");
  CHECK(wire_of("time a", R"({"a":{"secs":3}})") == "0300000000000000");
}

TEST_CASE("a flat list has every value in the order of the fields, and no other length") {
  CHECK(wire_of("int8 a\nPoint b\nint8[2] c\ntime d", "[1,0,0,2,3,4,5]") ==
        "01"
        "00000000000000000000000000000000"
        "0203"
        "0400000005000000");
  CHECK(wire_of("int8 a", "5") == "05");
  CHECK(wire_of("string a", R"("hi")") == "020000006869");
  CHECK(wire_of("int8 a\nint8 b", "[1]") ==
        "bad_value: demo/Main: 1 values, where 2 are needed; give every value in the order of the fields, or write an "
        "object");
  CHECK(wire_of("int8 a\nint8 b", "[1,2,3]").starts_with("bad_value: demo/Main: 3 values, where 2 are needed"));
  CHECK(wire_of("int8 a\nint8[] b", "[1,2]") ==
        "bad_value: demo/Main: has a part of free length, a list of values does not tell how long; write an object");
  CHECK(wire_of("Point a\nPoint b", R"([1,2,3,"x"])") == "bad_value: b.y: a text, where a number is needed");
  CHECK(wire_of("int8[2] a\ntime b", R"([1,2,-3,4])") ==
        "bad_value: b.secs: -3 is not a whole number from 0 to 4294967295");
}

TEST_CASE("an error names the field") {
  CHECK(wire_of("Point a", R"({"a":{"z":1}})") == "unknown_key: a: z: no field of demo/Point; it has x, y");
  CHECK(wire_of("Point[] a", R"({"a":[{},{"y":"no"}]})") == "bad_value: a[1].y: a text, where a number is needed");
  CHECK(wire_of("int8[3] a", R"({"a":[1]})") == "bad_value: a: 1 values, where 3 are needed");
  CHECK(wire_of("int8 a", R"({"a":128})") == "bad_value: a: 128 is not a whole number from -128 to 127");
  CHECK(wire_of("int8 a", R"({"a":1.5})") == "bad_value: a: not a whole number from -128 to 127");
  CHECK(wire_of("float32 a", R"({"a":1e300})") == "bad_value: a: a number that is too large for its type");
  CHECK(wire_of("uint64 a", R"({"a":1e19})").ends_with("write a large one as text"));
  CHECK(wire_of("uint64 a", R"({"a":"-1"})").starts_with("bad_value: a: text that is not a whole number"));
  CHECK(wire_of("bool a", R"({"a":2})") == "bad_value: a: a whole number, where true or false is needed");
  CHECK(wire_of("uint8[] a", R"({"a":"?"})").starts_with("bad_value: a: text that is no base64"));
  CHECK(wire_of("time a", R"({"a":{"seconds":2}})") == "unknown_key: a: has other keys than secs and nsecs");
  CHECK(wire_of("string a", R"({"a":5})") == "bad_value: a: a whole number, where text is needed");
  CHECK(wire_of("float64[200000] a", "{}") == "too_large: a: the message is over 1 MiB");
}

TEST_CASE("a message on the wire that ends too early or too late is refused where it does") {
  CHECK(json_of("int8 a\nint32 b", "010000") == "malformed: b: the message ends in it");
  CHECK(json_of("Point[] a", "02000000" + std::string(32, '0')) == "malformed: a: the message ends in it");
  CHECK(json_of("Point[2] a", std::string(32, '0')) == "malformed: a: the message ends in it");
  CHECK(json_of("string a", "05000000") == "malformed: a: the message ends in it");
  CHECK(json_of("int8 a", "0102") == "malformed: demo/Main: 1 bytes behind its end");
  CHECK(json_of("Nothing[] a", "ffffffff") == "too_large: a: more than 100000 elements");
  CHECK(json_of("bool a", "02") == "malformed: a: 2 is no bool");
}
