#include "services/virtual-robots/drone/navdata.hpp"

#include <bit>
#include <cmath>
#include <numbers>

namespace trb::virtual_robots::drone {
namespace {

/** Little-endian bytes. */
class Packet {
 public:
  Packet& u16(std::uint32_t value) { return add(value, 2); }
  Packet& u32(std::uint32_t value) { return add(value, 4); }
  Packet& f32(double value) { return u32(std::bit_cast<std::uint32_t>(static_cast<float>(value))); }
  Packet& zeros(std::size_t count) {
    bytes_.append(count, '\0');
    return *this;
  }
  std::uint32_t sum() const {
    std::uint32_t total = 0;
    for (const char byte : bytes_) total += static_cast<unsigned char>(byte);
    return total;
  }
  const std::string& bytes() const { return bytes_; }

 private:
  Packet& add(std::uint32_t value, int size) {
    for (; size > 0; --size, value >>= 8) bytes_ += static_cast<char>(value & 0xff);
    return *this;
  }

  std::string bytes_;
};

double millidegrees(double radians) {
  return radians * 180'000 / std::numbers::pi;
}

double millimetres(double metres) {
  return metres * 1000;
}

/** Control state, battery, angles, altitude and speeds; then 26 numbers about a camera that is not imitated. */
void add_demo(Packet& packet, const Aircraft& aircraft) {
  packet.u16(0).u16(148);
  packet.u32(static_cast<std::uint32_t>(aircraft.phase()) << 16);
  packet.u32(static_cast<std::uint32_t>(std::ceil(aircraft.battery())));
  packet.f32(millidegrees(aircraft.pitch())).f32(millidegrees(aircraft.roll())).f32(millidegrees(aircraft.heading()));
  packet.u32(static_cast<std::uint32_t>(std::lround(millimetres(aircraft.altitude()))));
  packet.f32(millimetres(aircraft.forward_speed())).f32(millimetres(aircraft.right_speed()));
  packet.f32(millimetres(aircraft.down_speed()));
  packet.zeros(std::size_t{27} * 4);
}

}  // namespace

std::string navdata_packet(std::uint32_t state, std::uint32_t sequence, const Aircraft& aircraft, bool demo) {
  Packet packet;
  packet.u32(0x55667788).u32(state).u32(sequence).u32(0);
  if (demo) add_demo(packet, aircraft);
  const std::uint32_t sum = packet.sum();
  packet.u16(0xffff).u16(8).u32(sum);
  return packet.bytes();
}

}  // namespace trb::virtual_robots::drone
