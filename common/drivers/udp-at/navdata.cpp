#include "common/drivers/udp-at/navdata.hpp"

#include <array>
#include <bit>
#include <cmath>
#include <numbers>
#include <numeric>

namespace trb::drivers {
namespace {

constexpr std::uint32_t kMagic = 0x55667788;
constexpr std::size_t kHeaderSize = 16;
constexpr std::size_t kOptionHeaderSize = 4;
constexpr std::size_t kDemoSize = 40;  ///< what is read of it; the drone sends more
constexpr std::size_t kChecksumSize = 8;
constexpr std::uint32_t kDemoTag = 0;
constexpr std::uint32_t kChecksumTag = 0xffff;

/// Little-endian numbers, unchecked: the caller has looked at the size.
std::uint32_t u16(BytesView bytes, std::size_t at) {
  return static_cast<unsigned char>(bytes[at]) | static_cast<std::uint32_t>(static_cast<unsigned char>(bytes[at + 1]))
                                                     << 8U;
}
std::uint32_t u32(BytesView bytes, std::size_t at) {
  return u16(bytes, at) | u16(bytes, at + 2) << 16U;
}
double f32(BytesView bytes, std::size_t at) {
  return static_cast<double>(std::bit_cast<float>(u32(bytes, at)));
}

Error malformed(const std::string& what) {
  return fail(Errc::malformed, "navdata: " + what, "look whether another device speaks on that port");
}

Result<ArDemo> read_demo(BytesView option) {
  constexpr double kRadians = std::numbers::pi / 180'000;  // from thousandths of a degree
  constexpr double kMetres = 0.001;
  const std::uint32_t control = u32(option, 4) >> 16U;
  const std::uint32_t battery = u32(option, 8);
  if (control >= enum_names(ArControl{}).size()) return malformed("no such control state");
  if (battery > 100) return malformed("a battery of more than 100 %");
  ArDemo demo;
  demo.control = static_cast<ArControl>(control);
  demo.battery = static_cast<int>(battery);
  // The drone's axes are forward, right, down.
  demo.pitch = -f32(option, 12) * kRadians;
  demo.roll = f32(option, 16) * kRadians;
  demo.yaw = -f32(option, 20) * kRadians;
  demo.altitude = static_cast<std::int32_t>(u32(option, 24)) * kMetres;
  demo.vx = f32(option, 28) * kMetres;
  demo.vy = -f32(option, 32) * kMetres;
  demo.vz = -f32(option, 36) * kMetres;
  const double sum = demo.pitch + demo.roll + demo.yaw + demo.vx + demo.vy + demo.vz;
  if (!std::isfinite(sum)) return malformed("an angle or a speed that is no number");
  return demo;
}

Status check_sum(BytesView datagram, std::size_t at) {
  const auto sum =
      std::accumulate(datagram.begin(), datagram.begin() + static_cast<std::ptrdiff_t>(at), std::uint32_t{0},
                      [](std::uint32_t so_far, char c) { return so_far + static_cast<unsigned char>(c); });
  if (u32(datagram, at + kOptionHeaderSize) == sum) return Done{};
  return fail(Errc::bad_signature, "navdata: wrong checksum");
}

}  // namespace

bool ArNavdata::airborne() const {
  const ArControl now = control();
  return has(kArFlying) && (now == ArControl::flying || now == ArControl::hovering || now == ArControl::going);
}

bool ArNavdata::landed() const {
  return !has(kArFlying) && control() != ArControl::taking_off && control() != ArControl::landing;
}

Result<ArNavdata> read_ar_navdata(BytesView datagram) {
  if (datagram.size() < kHeaderSize || u32(datagram, 0) != kMagic) return malformed("no header");
  ArNavdata out{u32(datagram, 4), u32(datagram, 8), {}};
  for (std::size_t at = kHeaderSize; at + kOptionHeaderSize <= datagram.size();) {
    const std::uint32_t tag = u16(datagram, at);
    const std::uint32_t size = u16(datagram, at + 2);
    if (size < kOptionHeaderSize || size > datagram.size() - at) return malformed("an option of a wrong size");
    if (tag == kChecksumTag) {
      if (size != kChecksumSize || at + size != datagram.size())
        return malformed("the checksum is not the last option");
      if (Status good = check_sum(datagram, at); !good) return good.error();
      return out;
    }
    if (tag == kDemoTag) {
      if (size < kDemoSize) return malformed("a demo option that is too short");
      auto demo = read_demo(datagram.substr(at, size));
      if (!demo) return demo.error();
      out.demo = *demo;
    }
    at += size;
  }
  return malformed("no checksum");
}

const std::vector<ArFault>& ar_faults() {
  static const std::vector<ArFault> faults = {
      {kArEmergency, "emergency", Severity::critical, "emergency: the motors are cut"},
      {1U << 12U, "motors_problem", Severity::critical, "motors: a problem"},
      {1U << 14U, "software_fault", Severity::critical, "software fault"},
      {kArBatteryLow, "battery_low", Severity::urgent, "battery low"},
      {1U << 19U, "angles_out_of_range", Severity::urgent, "angles out of range"},
      {1U << 22U, "cutout", Severity::urgent, "cutout: a motor was held or stopped"},
      {1U << 20U, "too_much_wind", Severity::warning, "too much wind"},
      {1U << 21U, "ultrasound_deaf", Severity::warning, "ultrasound: deaf, the altitude is not known"},
      {1U << 13U, "com_lost", Severity::warning, "the drone had lost its link"},
      {kArComWatchdog, "com_watchdog", Severity::warning, "the drone's watchdog: no command came for too long"},
  };
  return faults;
}

std::string ar_problems(std::uint32_t state) {
  std::string out;
  for (const ArFault& fault : ar_faults()) {
    if ((state & fault.bit) == 0 || fault.bit == kArEmergency) continue;
    out += (out.empty() ? "" : ", ") + std::string(fault.text);
  }
  return out;
}

}  // namespace trb::drivers
