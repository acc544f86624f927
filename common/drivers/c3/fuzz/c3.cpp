// What a C3 server answers: the packets whole and in pieces, the KRL values in them, and the mode behind.
#include "common/drivers/c3/krl.hpp"
#include "common/drivers/c3/wire.hpp"
#include "tests/fuzz/adapter_under_test.hpp"

namespace trb::fuzz {
namespace {

using namespace trb::adapter;

Bytes reply(int tag, std::string_view value) {
  Bytes body(1, '\0');
  body += {static_cast<char>(value.size() / 256), static_cast<char>(value.size() % 256)};
  body += value;
  body += {'\0', '\1', '\1'};
  return Bytes{'\0', static_cast<char>(tag), '\0', static_cast<char>(body.size())} + body;
}

Settings settings() {
  Settings out = robot_settings("kuka", Mode::direct, "c3", "grab");
  out.description.has_field_channel = true;
  out.commands.commands = {{"stop", "TRB_STOP = TRUE"}, {"release", "TRB_STOP = FALSE"}};
  out.commands.values = {{"position", "$POS_ACT X Y"}};
  return out;
}

/// The robot answers with the input, while a command is running.
void converse(BytesView input) {
  AdapterUnderTest adapter(settings());
  adapter.connect(Channel::command);
  adapter.hear(Channel::command, reply(1, "FALSE"));
  adapter.order({MessageType::command, "operator", "kuka", 1, 0, 0, 5000, Opaque{"wave", "1"}});
  adapter.hear_pieces(Channel::command, input, 32, std::chrono::milliseconds(60));
  adapter.check_answered(1);
}

}  // namespace

std::vector<Bytes> seeds() {
  Bytes all;
  for (int tag = 2; tag < 12; ++tag) all += reply(tag, tag % 2 == 0 ? "FALSE" : "TRUE");
  return {reply(1, "100"), reply(2, "{E6POS: X 1.5, Y -2.0E1, S 2, T 35}"), all, reply(2, "\"a \\q\\x41\\n\""),
          reply(2, "\"information\"") + reply(3, "\"greeting\"")};
}

void run(BytesView input) {
  std::vector<C3Reply> whole;
  std::vector<C3Reply> pieces;
  C3Reader one;
  C3Reader two;
  const bool good = one.add(input, whole).ok();
  bool still_good = true;
  for (std::size_t i = 0; i < input.size() && still_good; ++i) still_good = two.add(input.substr(i, 1), pieces).ok();
  require(good == still_good && whole.size() == pieces.size(), "pieces read as the whole");
  require(one.held() <= 65539, "what is held is bounded");
  for (const C3Reply& each : whole) {
    const auto value = read_krl(each.value, {});
    require(!value || parse_json(value->json).ok(), "a value is JSON");
    require(krl_text(krl_field(each.value)) == each.value, "a field is read as it was written");
  }
  converse(input);
}

}  // namespace trb::fuzz
