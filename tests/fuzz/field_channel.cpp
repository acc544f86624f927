// What a robot says on the field channel, in every framing and encoding; and two readers of it, written apart, that
// must agree: the mode-adapter's and that of `trb robot conform`.
#include "common/drivers/lines/driver.hpp"
#include "services/cli/conform/collector.hpp"
#include "services/cli/conform/wire.hpp"
#include "tests/fuzz/target.hpp"

namespace trb::fuzz {
namespace {

using namespace trb::drivers;
namespace conform = trb::cli::conform;

constexpr const char* kOwnId = "own";

/// The channel that the input's first byte asks for.
FieldChannel channel_of(unsigned char byte) {
  FieldChannel channel;
  channel.framing = (byte & 1U) != 0 ? Framing::length : Framing::newline;
  channel.encoding = (byte & 2U) != 0 ? Encoding::numeric : Encoding::text;
  channel.acknowledge = (byte & 4U) != 0;
  channel.chunk_bytes = (byte & 8U) != 0 ? 4 : 0;
  if ((byte & 16U) != 0) channel.framing = Framing::delay;
  channel.subtype_codes = {{"done", 1}, {"failed", 2}, {"fault", 3}, {"go", 4}, {"mobile", 5}};
  channel.id_codes = {{"cloud", 6}};
  return channel;
}

std::vector<std::string> fields_of(const FieldChannel& channel, BytesView bytes, std::size_t step) {
  FieldReader reader(channel);
  std::vector<std::string> fields;
  for (std::size_t at = 0; at < bytes.size(); at += step) {
    reader.add(bytes.substr(at, step), {});
    while (const auto field = reader.next({})) fields.emplace_back(*field);
  }
  return fields;
}

/// Any data arrives as it was, in chunks of which none is too long or reads as an order.
void check_sending(const FieldChannel& channel, BytesView data) {
  Bytes framed;
  std::size_t begin = 0;
  do {
    const std::size_t end = chunk_end(data, begin, channel);
    require(end > begin || data.empty(), "a chunk takes the data on");
    const BytesView chunk = data.substr(begin, end - begin);
    require(channel.encoding == Encoding::numeric || (chunk != "!stop" && chunk != "!release"), "no chunk is an order");
    append_field(framed, chunk, channel.framing);
    begin = end;
  } while (begin < data.size());
  std::string whole;
  conform::Cutter cutter(channel);
  cutter.add(framed);
  while (const auto field = cutter.next(false)) {
    require(field->fault.empty(), "a field that was sent is well-formed");
    whole += field->text;
  }
  require(whole == data, "data arrive as they were sent");
}

/// Until one of the two finds a fault in the input, both read the same messages.
void check_agreement(const FieldChannel& channel, BytesView bytes) {
  const FieldText words(channel, kOwnId);
  FieldReceiver receiver(words);
  const conform::Words other_words(channel, kOwnId);
  conform::Collector collector(other_words, false);
  conform::Cutter cutter(channel);
  cutter.add(bytes);
  for (const std::string& text : fields_of(channel, bytes, bytes.size() + 1)) {
    const auto field = cutter.next(false);
    if (!field || !field->fault.empty()) return;
    require(field->text == text, "both cut the same fields");
    const bool ok = receiver.between_messages() && (text == words.ok() || words.urgent_done(text));
    const auto heard = collector.take(text);
    if (ok) {
      require(heard && heard->kind != conform::Received::Kind::said, "both take it for no message");
      continue;
    }
    const auto message = receiver.take(text, false);
    if (!message || (heard && heard->kind == conform::Received::Kind::nonsense)) return;
    require(message->has_value() == heard.has_value(), "both see the same end of a message");
    if (!heard) continue;
    const FieldMessage& mine = **message;
    const std::string target = heard->said.target.empty() ? kOwnId : heard->said.target;
    require(mine.subtype == heard->said.subtype && mine.target == target && mine.data == heard->said.data,
            "both read the same message");
  }
}

/// The mode with a running command and a stop after it: whatever the robot sends, each is reported once.
void talk(const FieldChannel& channel, BytesView bytes, std::size_t step) {
  LinesDriver mode(channel, kOwnId);
  Outbox outbox;
  std::vector<EventFrom> events;
  RobotOutbox robot;
  const DriverOut out{&mode, outbox, robot, events};
  Now now{{1'000'000'000}, {1'800'000'000'000'000'000}};
  mode.on_up(Channel::field, now, out);
  const bool handed = mode.hand_over({1, MessageType::command, "go", "cloud", "1 2", "go"}, now, out).ok();
  for (std::size_t at = 0; at < bytes.size(); at += step) {
    if (at / step == 2)
      require(mode.online() ? mode.stop(now, out).ok() : true, "a robot that is there can be stopped");
    mode.on_bytes(Channel::field, bytes.substr(at, step), now, out);
    now.mono = now.mono + std::chrono::milliseconds(2);
    mode.tick(now, out);
  }
  std::size_t ended = 0;
  for (const EventFrom& from : events) {
    ended += std::holds_alternative<Ended>(from.event) || std::holds_alternative<Refused>(from.event) ? 1 : 0;
    if (const auto* said = std::get_if<Said>(&from.event)) {
      require(said->data.size() <= kMaxDataSize && !said->subtype.empty() && !said->target.empty(),
              "what is said is whole");
    }
  }
  require(ended <= (handed ? 1 : 0), "a command ends once");
  require(mode.online() || !robot.closes.empty(), "a channel that is given up is closed");
}

Bytes lines(char channel, const char* text) {
  return channel + Bytes(text);
}

/// With the framing `length`.
Bytes counted(const std::vector<std::string>& fields) {
  Bytes out = "\1";
  for (const std::string& field : fields) append_field(out, field, Framing::length);
  return out;
}

}  // namespace

std::vector<Bytes> seeds() {
  return {lines('\0', "information\ndone\n\n2\ngo\ncommand\ngo\ncloud\n5\na\\\\b\\n\n\n"),
          lines('\4', "ok\nok\nok\nok\nok\ninformation\nfailed\nown\n7\ngo busy\n!stopped\n!released\n"),
          lines('\4', "ok\nrequest\nposition\ncloud\n0\n\nok\n!stopped\n"),
          lines('\0', "information\nfault\n\n21\nmobile URGENT battery\n"),
          lines('\14', "information\ndone\n\n6\ngo \\\\\nx\ny\nok\n"),
          lines('\6', "0\n0\n0\n0\n0\n3\n1\n0\n1\n4\n-1\n-2\n3\n2\n6\n3\n4 1\n"),
          counted({"information", "done", "", "2", "go"}),
          lines('\20', "information"),
          lines('\20', "ok!stopped")};
}

void run(BytesView input) {
  if (input.empty()) return;
  const FieldChannel channel = channel_of(static_cast<unsigned char>(input[0]));
  const BytesView bytes = input.substr(1);
  if (channel.framing != Framing::delay) {
    require(fields_of(channel, bytes, 1) == fields_of(channel, bytes, bytes.size() + 1), "how bytes arrive is all one");
    check_sending(channel, bytes);
    check_agreement(channel, bytes);
  }
  talk(channel, bytes, bytes.size() + 1);
  talk(channel, bytes, 7);
}

}  // namespace trb::fuzz
