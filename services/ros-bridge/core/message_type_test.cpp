// ROS message definitions: what is read, what is refused, and the sums that other ROS nodes compute.
#include "services/ros-bridge/core/message_type.hpp"

#include <doctest/doctest.h>

using namespace trb;
using namespace trb::ros;

namespace {

const std::map<std::string, std::string> kTexts = {
    {"geometry_msgs/Vector3", "# a vector\nfloat64 x\nfloat64 y\nfloat64 z\n"},
    {"geometry_msgs/Twist", "Vector3 linear\nVector3  angular # in rad/s\n"},
    {"std_msgs/Header", "uint32 seq\ntime stamp\nstring frame_id\n"},
    {"std_msgs/Empty", ""},
    {"demo/Stamped", "Header header\ngeometry_msgs/Twist[2] twists\nfloat64[36] covariance\nuint8[] data\n"},
    {"demo/Words", "string GREETING= hello # world \nint8 LIMIT = -5 # a comment\nstring text\n"},
    {"demo/Ring", "demo/Link next\n"},
    {"demo/Link", "Ring[] rings\n"},
    {"demo/Gap", "Nowhere field\n"},
};

TypeStore make_store() {
  return TypeStore([](const std::string& type) -> Result<std::string> {
    const auto at = kTexts.find(type);
    if (at == kTexts.end()) return fail(Errc::missing, type + ": no definition");
    return at->second;
  });
}

}  // namespace

TEST_CASE("the sums of known messages are those that every ROS node compares") {
  TypeStore store = make_store();
  CHECK((*store.find("geometry_msgs/Twist"))->md5 == "9f195f881246fdfa2798d1d3eebca84a");
  CHECK((*store.find("geometry_msgs/Vector3"))->md5 == "4a842b65f413084dc2b10fb484ea7f17");
  CHECK((*store.find("std_msgs/Header"))->md5 == "2176decaecbce78abc3b96ef049fabed");
  CHECK((*store.find("std_msgs/Empty"))->md5 == "d41d8cd98f00b204e9800998ecf8427e");
}

TEST_CASE("a type knows how many values it has, if no part's length is free") {
  TypeStore store = make_store();
  CHECK((*store.find("geometry_msgs/Twist"))->values == 6U);
  CHECK((*store.find("geometry_msgs/Twist"))->least_size == 48);
  const auto header = *store.find("std_msgs/Header");
  CHECK(header->values == 4U);
  CHECK(header->least_size == 16);
  const auto stamped = *store.find("demo/Stamped");
  CHECK_FALSE(stamped->values);
  CHECK(stamped->least_size == 16 + 2 * 48 + 36 * 8 + 4);
  CHECK(stamped->fields[0].message->name == "std_msgs/Header");
  CHECK(stamped->fields[1].message->name == "geometry_msgs/Twist");
  CHECK(stamped->fields[1].length == 2U);
}

TEST_CASE("a string constant goes to the end of its line") {
  const auto text = parse_message_text(kTexts.at("demo/Words"));
  REQUIRE(text.ok());
  CHECK(text->constants[0].value == "hello # world");
  CHECK(text->constants[1].name == "LIMIT");
  CHECK(text->constants[1].value == "-5");
  CHECK(text->fields[0].name == "text");
}

TEST_CASE("a definition that is none is refused with its line") {
  const auto what = [](std::string_view text) {
    const auto parsed = parse_message_text(text);
    return parsed ? std::string("taken") : parsed.error().what;
  };
  CHECK(what("int8 a\nint8\n") == "line 2: a type without a name");
  CHECK(what("int8 a\nint16 a\n") == "line 2: a occurs twice");
  CHECK(what("int8[x] a") == "line 1: 'int8[x]' is no array");
  CHECK(what("int8[ a") == "line 1: 'int8[' is no array");
  CHECK(what("int8[-1] a") == "line 1: 'int8[-1]' is no array");
  CHECK(what("int8[99999999999] a") == "line 1: 'int8[99999999999]' is no array");
  CHECK(what("a/b/c d") == "line 1: 'a/b/c' is no type");
  CHECK(what("int8 1a") == "line 1: '1a' is no name");
  CHECK(what("time T=3") == "line 1: a constant cannot be of type 'time'");
  CHECK(what("int8 A=") == "line 1: a constant without a value");
  CHECK(what(std::string(300'000, '#')) == "a message definition of over 256 KiB");
}

TEST_CASE("types that contain each other, or that nobody knows, are refused by name") {
  TypeStore store = make_store();
  CHECK(store.find("demo/Ring").error().what.find("demo/Ring: contains itself") != std::string::npos);
  CHECK(store.find("demo/Gap").error().what == "demo/Gap.field: demo/Nowhere: no definition");
  CHECK(store.find("Twist").error().hint == "write package/Name");
  CHECK(store.find("../etc/passwd").error().code == Errc::bad_value);
  CHECK(store.find("a/../../b").error().code == Errc::bad_value);
}

TEST_CASE("the definition in a connection's header brings every type along") {
  const std::string border = "\n" + std::string(80, '=') + "\n";
  const std::string full =
      kTexts.at("geometry_msgs/Twist") + border + "MSG: geometry_msgs/Vector3\n" + kTexts.at("geometry_msgs/Vector3");
  const auto type = type_from_full_definition("geometry_msgs/Twist", full);
  REQUIRE(type.ok());
  CHECK((*type)->md5 == "9f195f881246fdfa2798d1d3eebca84a");
  CHECK(full_definition(**type) == full);
  CHECK(type_from_full_definition("geometry_msgs/Twist", kTexts.at("geometry_msgs/Twist")).error().code ==
        Errc::missing);
  CHECK(type_from_full_definition("geometry_msgs/Twist", "int8 a" + border + "int8 b").error().code == Errc::malformed);
}
