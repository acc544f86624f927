// What a robot sends on the field channel: framing, words, and the interpreter mode behind them.
#define DOCTEST_CONFIG_DISABLE  // the fixture is for doctest; here require() tells
#include "common/drivers/lines/frame.hpp"
#include "common/drivers/lines/receiver.hpp"
#include "services/mode-adapter/test/fixture.hpp"
#include "tests/fuzz/target.hpp"

namespace trb::fuzz {
namespace {

using namespace trb::adapter;

FieldChannel channel(Framing framing, Encoding encoding) {
  FieldChannel out;
  out.framing = framing;
  out.encoding = encoding;
  out.subtype_codes = {{"done", 1}, {"failed", 2}, {"go_to", 3}, {"mobile", 4}, {"position", 5}};
  out.id_codes = {{"operator", 1}, {"pioneer", 2}};
  return out;
}

/// The fields that a reader cuts from the bytes, in pieces of that size.
std::vector<Bytes> fields_of(BytesView input, const FieldChannel& settings, std::size_t piece) {
  FieldReader reader(settings);
  std::vector<Bytes> fields;
  for (; !input.empty(); input.remove_prefix(std::min(piece, input.size()))) {
    reader.add(input.substr(0, piece), MonotonicTime{1});
    while (const auto field = reader.next(MonotonicTime{1})) fields.emplace_back(*field);
  }
  return fields;
}

void check_framing(BytesView input) {
  for (const Framing framing : {Framing::newline, Framing::length}) {
    const FieldChannel settings = channel(framing, Encoding::text);
    const auto fields = fields_of(input, settings, input.size() + 1);
    require(fields == fields_of(input, settings, 1), "fields do not depend on how the stream is cut");
    Bytes again;
    for (const Bytes& field : fields) append_field(again, field, framing);
    require(fields_of(again, settings, 7) == fields, "a field that was read is written so that it reads the same");
  }
}

void check_receiver(BytesView input, Encoding encoding) {
  const FieldChannel settings = channel(Framing::newline, encoding);
  const FieldText words(settings, "pioneer");
  FieldReceiver receiver(words);
  for (const Bytes& field : fields_of(input, settings, input.size() + 1)) {
    const auto message = receiver.take(field, false);
    if (!message) return;
    if (!*message) continue;
    require(receiver.between_messages(), "after a message the next field begins one");
    require((*message)->type != MessageType::none, "a message has a type");
  }
}

/// A skill that runs while the robot sends this has an outcome in the end, and no message that the middleware keeps for
/// itself goes to another node.
void check_mode(BytesView input, Framing framing, Encoding encoding) {
  Settings settings = pioneer();
  settings.description.field_channel = channel(framing, encoding);
  settings.description.sensors = {"position"};
  Fixture fixture(std::move(settings));
  fixture.up(Channel::field);
  fixture.deliver(MessageType::command, order("go_to", R"({"place": "dock"})"), "pioneer");
  fixture.say(input);
  for (const Send& send : fixture.out.sends) {
    const auto* opaque = get_if<Opaque>(&send.body);
    require(opaque == nullptr || !is_reserved(opaque->subtype), "a robot says no word of the middleware's");
  }
  fixture.wait(30);
  require(!fixture.told<Outcome>().empty(), "the skill has an outcome");
}

}  // namespace

std::vector<Bytes> seeds() {
  return {"ok\nok\nok\nok\nok\ninformation\ndone\n\n5\ngo_to\n",
          "information\nfault\n\n18\nmobile FATAL wheel\n",
          "information\nposition\npioneer\n3\n1 2\n!stopped\n!released\n",
          "command\nmove\\n\\\\x\nridgeback\n0\n\n",
          "3\n2\n0\n3\n1 2\n-1\n-2\n0\n",
          Bytes("\0\0\0\2ok\0\0\0\13information", 21)};
}

void run(BytesView input) {
  check_framing(input);
  for (const Encoding encoding : {Encoding::text, Encoding::numeric}) {
    check_receiver(input, encoding);
    for (const Framing framing : {Framing::newline, Framing::length, Framing::delay})
      check_mode(input, framing, encoding);
  }
}

}  // namespace trb::fuzz
