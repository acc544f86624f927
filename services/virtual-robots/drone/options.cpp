#include "services/virtual-robots/drone/options.hpp"

#include <array>
#include <cmath>
#include <numbers>

#include "services/virtual-robots/drone/packet.hpp"

namespace trb::virtual_robots::drone {
namespace {

/** The options by their tags: their numbers and sizes as the SDK 2's navdata_common.h has them. */
enum class Tag : std::uint32_t {
  demo = 0,
  time = 1,
  raw_measures = 2,
  phys_measures = 3,
  euler_angles = 5,
  altitude = 10,
  magneto = 22,
  wifi = 26,
};

constexpr std::array<std::uint16_t, kOptionTags> kSizes = {148, 8,   52,  46, 16, 12, 88, 16, 24, 76, 56, 16, 44, 92,
                                                           108, 364, 328, 8,  40, 65, 12, 18, 75, 56, 72, 32, 8,  12};
constexpr double kGravity_mg = 1000;
constexpr double kEmpty_mV = 10'500;  // a lithium battery of three cells; a straight line between is invented
constexpr double kFull_mV = 12'500;

double millidegrees(double radians) {
  return radians * 180'000 / std::numbers::pi;
}

double millimetres(double metres) {
  return metres * 1000;
}

std::int32_t whole(double number) {
  return static_cast<std::int32_t>(std::lround(number));
}

/** Control state, battery, angles, altitude and speeds; then 27 numbers about a camera that is not imitated. */
void add_demo(Packet& packet, const Aircraft& aircraft) {
  packet.u32(static_cast<std::uint32_t>(aircraft.phase()) << 16);
  packet.u32(static_cast<std::uint32_t>(std::ceil(aircraft.battery())));
  packet.f32(millidegrees(aircraft.pitch())).f32(millidegrees(aircraft.roll())).f32(millidegrees(aircraft.heading()));
  packet.i32(whole(millimetres(aircraft.altitude())));
  packet.f32(millimetres(aircraft.forward_speed())).f32(millimetres(aircraft.right_speed()));
  packet.f32(millimetres(aircraft.down_speed()));
}

/** Since the drone's start: seconds in the upper 11 bits, microseconds in the lower 21. */
void add_time(Packet& packet, double uptime_s) {
  constexpr double kWraps = 2048;
  const double time = std::fmod(uptime_s, kWraps);
  const double seconds = std::floor(time);
  packet.u32(static_cast<std::uint32_t>(seconds) << 21U | static_cast<std::uint32_t>((time - seconds) * 1e6));
}

/** Before the voltage: accelerometers, gyrometers, gyrometers of 110 degrees/s, as raw numbers. */
void add_raw_measures(Packet& packet, const Aircraft& aircraft) {
  packet.zeros(16).u32(
      static_cast<std::uint32_t>(whole(kEmpty_mV + (kFull_mV - kEmpty_mV) * aircraft.battery() / 100)));
}

/** Before the accelerations (mg): two temperatures. It flies without a jerk: only its weight is felt. */
void add_phys_measures(Packet& packet) {
  packet.zeros(6).f32(0).f32(0).f32(-kGravity_mg);
}

void add_altitude(Packet& packet, const Aircraft& aircraft) {
  const std::int32_t altitude = whole(millimetres(aircraft.altitude()));
  packet.i32(altitude).f32(-millimetres(aircraft.down_speed())).i32(altitude).i32(altitude);
}

/** Before the headings (degrees): three raw numbers and three vectors. North is where it looked at its start. */
void add_magneto(Packet& packet, const Aircraft& aircraft) {
  const double degrees = millidegrees(aircraft.heading()) / 1000;
  packet.zeros(42).f32(degrees).f32(degrees).f32(degrees).u8(1);
}

void add_content(Packet& packet, Tag tag, const Aircraft& aircraft, double uptime_s) {
  if (tag == Tag::demo) add_demo(packet, aircraft);
  if (tag == Tag::time) add_time(packet, uptime_s);
  if (tag == Tag::raw_measures) add_raw_measures(packet, aircraft);
  if (tag == Tag::phys_measures) add_phys_measures(packet);
  if (tag == Tag::euler_angles) packet.f32(millidegrees(aircraft.pitch())).f32(millidegrees(aircraft.roll()));
  if (tag == Tag::altitude) add_altitude(packet, aircraft);
  if (tag == Tag::magneto) add_magneto(packet, aircraft);
  if (tag == Tag::wifi) packet.u32(100);
}

}  // namespace

std::string navdata_option(std::uint32_t tag, const Aircraft& aircraft, double uptime_s) {
  Packet packet;
  packet.u16(tag).u16(kSizes.at(tag));
  add_content(packet, static_cast<Tag>(tag), aircraft, uptime_s);
  packet.zeros(kSizes.at(tag) - packet.bytes().size());
  return packet.bytes();
}

}  // namespace trb::virtual_robots::drone
