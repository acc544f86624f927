// What a RAPID server answers: texts whole and in pieces, and the mode behind, on both connections.
#include "common/drivers/rapid/wire.hpp"
#include "tests/fuzz/adapter_under_test.hpp"

namespace trb::fuzz {
namespace {

using namespace trb::adapter;

Settings settings() {
  Settings out = robot_settings("abb", Mode::direct, "rapid", "grab");
  out.commands.commands = {{"move", "2 1 1"}, {"stop", "service 91"}, {"release", "service 92"}};
  out.commands.values = {{"joints", "service 4 0 1"}, {"position", "3 0"}};
  return out;
}

/// The robot sends the input on that connection, while a move is running.
void converse(Channel channel, BytesView input) {
  AdapterUnderTest adapter(settings());
  adapter.connect(Channel::command);
  adapter.connect(Channel::monitor);
  adapter.hear(Channel::monitor, "90 1 0 0 1 0#");
  adapter.order({MessageType::command, "operator", "abb", 1, 0, 0, 5000, Opaque{"move", ""}});
  adapter.hear_pieces(channel, input, 16, std::chrono::milliseconds(110));
  adapter.check_answered(1);
}

}  // namespace

std::vector<Bytes> seeds() {
  return {"2 1#", "2 0 J2%20200%20is%20out%20of%20range#", "4 1 1.5 -2 3#90 1 1 0 0 50204 grab%20URGENT%20x#",
          "90 1 0 1 1 0#4 1 0 0#90 1 0 1 0 7#", "2 1 \n3 1 10.5 20 30\n"};
}

void run(BytesView input) {
  RapidReader one;
  RapidReader two;
  const MonotonicTime now{1};
  one.add(input, now);
  for (std::size_t i = 0; i < input.size(); ++i) two.add(input.substr(i, 1), now);
  while (const auto text = one.next(now)) {
    require(two.next(now) == text, "pieces read as the whole");
    const auto answer = read_rapid_answer(*text);
    require(!answer || (answer->code >= 0 && answer->code <= 9999), "a code is a code");
    const auto literal = rapid_literal(Value{*text});
    require(literal.ok() && literal->find_first_of(" #\n\"") == std::string::npos, "a text ends nothing");
    require(rapid_unescaped(*literal) == *text, "a text is read as it was written");
  }
  require(!two.next(now), "pieces read as the whole");
  converse(Channel::command, input);
  converse(Channel::monitor, input);
}

}  // namespace trb::fuzz
