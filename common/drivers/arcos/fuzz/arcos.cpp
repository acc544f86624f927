// A Pioneer's input: its packets, however they are cut, and the state machine that receives them.
#include <cmath>

#include "common/drivers/arcos/state.hpp"
#include "tests/fuzz/adapter_under_test.hpp"

namespace trb::fuzz {
namespace {

using namespace trb::adapter;

Bytes packet(const Bytes& body) {
  const std::uint16_t sum = arcos_checksum(body);
  return "\xfa\xfb" + Bytes(1, static_cast<char>(body.size() + 2)) + body + static_cast<char>(sum >> 8U) +
         static_cast<char>(sum & 0xffU);
}

const Bytes& hand_shake() {
  static const Bytes bytes = packet(Bytes(1, '\0')) + packet("\x01") + packet(Bytes("\x02Pio\0Pioneer\0p3dx\0", 18));
  return bytes;
}

/// 1.5 m to the east, at rest, motors on, one sonar reading.
Bytes sip(char type, std::uint8_t east) {
  Bytes body(1, type);
  body += static_cast<char>(east);
  return packet(body +
                Bytes("\x05\0\0\0\x04\0\0\0\0\x7d\0\0\0\0\x01\0\0\x01\x03\x88\x13\0\0\0\0\0\x7d\0\0\0\0\0\0", 33));
}

Settings pioneer() {
  Settings settings;
  settings.id = "pioneer";
  settings.framework = "pioneer";
  settings.mode = Mode::direct;
  settings.description.capabilities = {"mobile"};
  settings.commands.transport = "arcos";
  settings.commands.port = 8101;
  settings.commands.values = {{"position", "x y heading"}, {"battery", "battery state_of_charge bumpers"}};
  settings.commands.commands = {{"go_to", "goto {0} {1} {2}"}, {"origin", "SETO"}, {"stop", "STOP"}};
  return settings;
}

/// Every byte that goes to the robot is a packet.
void check_writes(const RobotOutbox& out) {
  ArcosReader reader;
  std::vector<ArcosPacket> packets;
  for (const RobotWrite& write : out.writes) reader.add(write.bytes, packets);
  const ArcosReader::Losses losses = reader.take_losses();
  require(losses.garbage == 0 && losses.wrong == 0, "what is written is packets");
}

void cut(BytesView input) {
  ArcosReader whole;
  ArcosReader single;
  std::vector<ArcosPacket> at_once;
  std::vector<ArcosPacket> byte_by_byte;
  whole.add(input, at_once);
  for (const char c : input) single.add(BytesView(&c, 1), byte_by_byte);
  require(at_once.size() == byte_by_byte.size(), "packets are the same however they are cut");
  std::size_t size = whole.take_losses().garbage;
  ArcosOdometry place;
  for (std::size_t i = 0; i < at_once.size(); ++i) {
    require(at_once[i].contents == byte_by_byte[i].contents, "their contents, too");
    size += at_once[i].contents.size() + 6;
    const auto read = read_arcos_sip(at_once[i]);
    if (!read) continue;
    require(std::abs(read->heading) <= 180, "a heading is within half a turn");
    place.update(*read);
    require(std::abs(place.x()) <= 32768.0 * static_cast<double>(i + 1), "no packet is a way of more than 32 m");
  }
  require(size <= input.size(), "no byte is read twice");
}

/// The input is what the robot sends: from the connection on, and while a command is carried out.
void converse(const Bytes& before, BytesView input) {
  AdapterUnderTest adapter(pioneer());
  adapter.connect(Channel::command);
  adapter.hear(Channel::command, before);
  Inbound order;
  order.type = MessageType::command;
  order.source = "operator";
  order.target = "pioneer";
  order.id = 1;
  order.remaining_ms = 1000;
  order.body = Opaque{"go_to", "[3000, -2000, 90]"};
  adapter.order(order);
  while (!input.empty()) {
    const BytesView part = input.substr(0, 64);
    input.remove_prefix(part.size());
    adapter.now.mono = adapter.now.mono + std::chrono::milliseconds(200);
    adapter.hear(Channel::command, part);
    adapter.pass({});
  }
  check_writes(adapter.core.take_robot_output());
}

/// The input as contents of reports with a right checksum: 40 bytes each.
Bytes reports_of(BytesView input) {
  Bytes out;
  while (!input.empty()) {
    const BytesView part = input.substr(0, 40);
    input.remove_prefix(part.size());
    const char type = (part.front() & 1) != 0 ? '\x33' : '\x32';
    out += packet(type + Bytes(part.substr(1)));
  }
  return out;
}

}  // namespace

std::vector<Bytes> seeds() {
  const Bytes way = sip('\x32', 0xdc) + sip('\x33', 0xe0) + sip('\x32', 0xff);
  const Bytes at_rest(Bytes("\x02\xdc\x05\0\0\0\x04\0\0\0\0\x7d\0\0\0\0\x01\0\0\x01\x03\x88\x13", 23));
  return {hand_shake(), hand_shake() + way, way, at_rest + Bytes(17, '\0') + at_rest,
          way + way + packet(Bytes("\x20Pioneer\0", 9)) + "\xfa\xfb\x03"};
}

void run(BytesView input) {
  cut(input);
  converse({}, input);
  converse(hand_shake() + sip('\x32', 0xdc), input);
  const Bytes reports = reports_of(input);
  cut(reports);
  converse(hand_shake() + sip('\x32', 0xdc), reports);
}

}  // namespace trb::fuzz
