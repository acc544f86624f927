// What a ROS peer can send: a definition in a connection's header, and a message of it; converted to JSON and back.
#include <algorithm>

#include "services/ros-bridge/core/message_codec.hpp"
#include "tests/fuzz/target.hpp"

namespace trb::fuzz {
namespace {

using namespace trb::ros;

const std::string kLine(80, '=');
/// Every kind of field, nested, in arrays of both kinds.
const std::string kEverything =
    "bool yes\nint8 a\nuint8 b\nint16 c\nuint16 d\nint32 e\nuint32 f\nint64 g\nuint64 h\nfloat32 i\nfloat64 j\n"
    "string text\ntime when\nduration long\nuint8[] bytes\nuint8[3] three\nstring[] words\nfloat64[2] pair\n"
    "Point[] way\nPoint[2] ends\nint32 ONE=1\nstring NAME=a b # c\n" +
    kLine + "\nMSG: geometry_msgs/Point\nfloat64 x\nfloat64 y\n";
const std::string kName = "geometry_msgs/Everything";
constexpr char kBorder = '\0';

bool has_unmeasured(const Value& json) {
  if (json.is_null()) return true;
  if (json.is_list()) return std::ranges::any_of(json.list(), has_unmeasured);
  return json.is_object() &&
         std::ranges::any_of(json.object(), [](const auto& one) { return has_unmeasured(one.second); });
}

/// A part of a message has the fields that were asked for, with the values that they have in the whole.
void check_parts(const RosType& type, BytesView wire, const Value& whole) {
  for (const auto& [name, value] : whole.object()) {
    const auto part = to_json(type, wire, {name + ".of.any"});
    require(part.ok(), "a part of a message that can be read can be read");
    const auto& fields = part->object();
    require(fields.size() == 1 && fields.front().first == name, "a part has the field that was asked for");
    require(dump_json(fields.front().second) == dump_json(value), "and the value of the whole");
  }
}

void check_message(const RosType& type, BytesView wire) {
  (void)to_json(type, wire, {"bytes", "way[0].x", "text"});
  const auto json = to_json(type, wire);
  if (!json) return;
  check_parts(type, wire, *json);
  const auto again = to_wire(type, *json);
  if (has_unmeasured(*json)) return require(!again.ok(), "no number that is not finite is written");
  require(again.ok(), "what was read from the wire can be written again");
  // A bool on the wire may be any byte that is not 0.
  const auto second = to_json(type, *again);
  require(second.ok() && dump_json(*second) == dump_json(*json), "and says the same");
}

}  // namespace

std::vector<Bytes> seeds() {
  const auto type = type_from_full_definition(kName, kEverything);
  require(type.ok(), "the seed's definition is one");
  const auto zero = to_wire(**type, Value{Value::Object{}});
  const auto full = parse_json(
      R"({"yes":true,"a":-1,"h":"18446744073709551615","i":0.5,"j":1.5,"text":"ä","when":{"secs":1,"nsecs":2},)"
      R"("bytes":"AAEC","words":["a",""],"way":[{"x":1,"y":-0.0}]})");
  const auto wire = to_wire(**type, *full);
  require(zero.ok() && wire.ok(), "the seeds' messages are some");
  const Bytes not_a_number = "\x01\x02\x03\x04\x05\x06\xf8\x7f";
  return {kEverything + kBorder + *zero, kEverything + kBorder + *wire,
          "float64 x" + std::string(1, kBorder) + not_a_number,
          "float64 x\nfloat64 y" + std::string(1, kBorder) + Bytes(16, '\1'), "string data" + std::string(1, kBorder)};
}

/// A definition, a zero byte, a message.
void run(BytesView input) {
  const std::size_t border = std::min(input.find(kBorder), input.size());
  const BytesView wire = input.substr(std::min(border + 1, input.size()));
  const auto given = type_from_full_definition(kName, input.substr(0, border));
  if (given) {
    check_message(**given, wire);
    const auto same = type_from_full_definition(kName, full_definition(**given));
    require(same.ok() && (*same)->md5 == (*given)->md5, "a type's own definition is its type");
  }
  static const auto known = type_from_full_definition(kName, kEverything);
  check_message(**known, wire);
  if (const auto json = parse_json(input)) (void)to_wire(**known, *json);
}

}  // namespace trb::fuzz
