#pragma once

#include <cstdint>
#include <string>

#include "services/virtual-robots/drone/aircraft.hpp"

namespace trb::virtual_robots::drone {

/** Bits of the state in navdata's header. */
namespace bits {
constexpr std::uint32_t kFlying = 1U << 0;
constexpr std::uint32_t kAltitudeControl = 1U << 4;
constexpr std::uint32_t kCommandTaken = 1U << 6;
constexpr std::uint32_t kCameraReady = 1U << 7;
constexpr std::uint32_t kDemo = 1U << 10;
constexpr std::uint32_t kBootstrap = 1U << 11;
constexpr std::uint32_t kComLost = 1U << 13;
constexpr std::uint32_t kBatteryLow = 1U << 15;
constexpr std::uint32_t kAnglesOutOfRange = 1U << 19;
constexpr std::uint32_t kTooMuchWind = 1U << 20;
constexpr std::uint32_t kCutout = 1U << 22;
constexpr std::uint32_t kPicVersionOk = 1U << 23;
constexpr std::uint32_t kThreads = 0xfU << 24;
constexpr std::uint32_t kComWatchdog = 1U << 30;
constexpr std::uint32_t kEmergency = 1U << 31;
}  // namespace bits

/** Which options a client has asked for: none yet, the demo and some, or every one. */
enum class NavdataKind : std::uint8_t { bootstrap, demo, all };

struct NavdataWish {
  NavdataKind kind = NavdataKind::bootstrap;
  std::uint32_t options = 1U << 0 | 1U << 16;  ///< a bit each, beside the demo: vision_detect, as the drone has it set
};

/** One datagram: header, the options that are wished, checksum. `uptime_s` is since the drone's start. */
std::string navdata_packet(std::uint32_t state, std::uint32_t sequence, const Aircraft& aircraft,
                           const NavdataWish& wish, double uptime_s);

}  // namespace trb::virtual_robots::drone
