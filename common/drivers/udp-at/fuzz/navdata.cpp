// A drone's datagrams: arbitrary navdata, navdata with a correct checksum, and the mode that receives them.
#include <cmath>

#include "common/drivers/udp-at/commands.hpp"
#include "common/drivers/udp-at/driver.hpp"
#include "common/drivers/udp-at/values.hpp"
#include "tests/fuzz/driver_under_test.hpp"

namespace trb::fuzz {
namespace {

using namespace trb::drivers;

constexpr std::size_t kChecksumSize = 8;

Bytes little_endian(std::uint32_t value, int size) {
  Bytes out;
  for (int i = 0; i < size; ++i) out += static_cast<char>((value >> (8 * i)) & 0xffU);
  return out;
}

Bytes with_checksum(BytesView packet) {
  std::uint32_t sum = 0;
  for (const char c : packet) sum += static_cast<unsigned char>(c);
  return Bytes(packet) + little_endian(0xffff, 2) + little_endian(kChecksumSize, 2) + little_endian(sum, 4);
}

Bytes packet(std::uint32_t state, std::uint32_t control, bool demo) {
  Bytes out = little_endian(0x55667788, 4) + little_endian(state, 4) + little_endian(7, 4) + little_endian(0, 4);
  if (demo) {
    out += little_endian(0, 2) + little_endian(148, 2) + little_endian(control << 16U, 4) + little_endian(80, 4);
    out += Bytes(136, '\0');
  }
  return with_checksum(out);
}

DriverSettings settings() {
  DriverSettings out;
  out.id = "drone";
  out.commands.transport = "udp-at";
  out.commands.commands = {{"take_off", "REF take_off"}, {"stop", "hover"}, {"name", "CONFIG \"n\" {data}"}};
  return out;
}

void check_writes(const RobotOutbox& out) {
  for (const RobotWrite& write : out.writes) {
    if (write.channel != Channel::command) continue;
    require(write.bytes.size() <= 1024, "a datagram fits the drone");
    require(write.bytes.starts_with("AT*") && write.bytes.ends_with("\r"), "a datagram is whole commands");
  }
}

/// The mode receives it in the middle of a take-off and of a setting; it must keep sending AT, and answer every
/// command.
void hear(BytesView datagram) {
  DriverUnderTest driver(make_with<AtDriver, read_at_commands>(settings()));
  Driver& mode = *driver.mode;
  const DriverOut to = driver.to();
  Now& now = driver.now;
  mode.on_up(Channel::monitor, now, to);
  mode.on_bytes(Channel::monitor, packet(0, 2, true), now, to);
  require(mode.online(), "a good navdata makes the link");
  require(mode.hand_over({1, MessageType::command, "take_off", "me", "", {}}, now, to).ok(), "it may take off");
  require(mode.hand_over({2, MessageType::command, "name", "me", "\"x\"", {}}, now, to).ok(), "it may be named");
  now.mono = now.mono + std::chrono::milliseconds(200);
  mode.on_bytes(Channel::monitor, datagram, now, to);
  mode.tick(now, to);
  for (int i = 0; i < 5; ++i) {
    now.mono = now.mono + std::chrono::seconds(1);
    mode.tick(now, to);
  }
  require(!mode.online(), "silence is noticed");
  int answered = 0;
  for (const EventFrom& from : driver.events) {
    if (const auto* taken = std::get_if<HandedOver>(&from.event)) answered += taken->token == 2 ? 1 : 0;
    if (const auto* refused = std::get_if<Refused>(&from.event)) answered += refused->token == 2 ? 1 : 0;
  }
  require(answered == 1, "who waits for a setting is answered once");
  check_writes(driver.robot);
}

void read(BytesView datagram) {
  const auto drone = read_ar_navdata(datagram);
  if (!drone) return;
  for (const ArValue& value : ar_values(*drone)) {
    require(std::isfinite(value.number), "a value is a number");
    require(parse_json(value.json).ok(), "a value is JSON");
  }
}

}  // namespace

std::vector<Bytes> seeds() {
  return {packet(1U << 11U, 0, false), packet(1, 4, true), packet(1U << 31U, 0, true),
          packet((1U << 6U) | 1U, 6, true)};
}

void run(BytesView input) {
  read(input);
  const Bytes summed = with_checksum(input.substr(0, input.size() - std::min(input.size(), kChecksumSize)));
  read(summed);
  hear(input);
  hear(summed);
}

}  // namespace trb::fuzz
