#include "services/virtual-robots/drone/navdata.hpp"

#include "services/virtual-robots/drone/options.hpp"
#include "services/virtual-robots/drone/packet.hpp"

namespace trb::virtual_robots::drone {
namespace {

constexpr std::uint32_t kMagic = 0x55667788;
constexpr std::uint32_t kVisionDefined = 1;
constexpr std::uint32_t kEvery = (1U << kOptionTags) - 1;
constexpr std::uint32_t kDemoTag = 1U << 0;

std::uint32_t sent_options(const NavdataWish& wish) {
  if (wish.kind == NavdataKind::bootstrap) return 0;
  return wish.kind == NavdataKind::all ? kEvery : (wish.options | kDemoTag) & kEvery;
}

}  // namespace

std::string navdata_packet(std::uint32_t state, std::uint32_t sequence, const Aircraft& aircraft,
                           const NavdataWish& wish, double uptime_s) {
  Packet packet;
  packet.u32(kMagic).u32(state).u32(sequence).u32(kVisionDefined);
  const std::uint32_t options = sent_options(wish);
  for (std::uint32_t tag = 0; tag < kOptionTags; ++tag) {
    if ((options >> tag & 1U) != 0) packet.bytes(navdata_option(tag, aircraft, uptime_s));
  }
  const std::uint32_t sum = packet.sum();
  packet.u16(0xffff).u16(8).u32(sum);
  return packet.bytes();
}

}  // namespace trb::virtual_robots::drone
