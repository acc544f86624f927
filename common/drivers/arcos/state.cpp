#include "common/drivers/arcos/state.hpp"

#include <cmath>
#include <cstdlib>

namespace trb::drivers {
namespace {

constexpr double kDegreesPerUnit = 360.0 / 4096;
constexpr int kStandingSpeed = 2;  ///< mm/s: what encoders may still show while the robot stands
constexpr int kNearOrigin = 200;   ///< mm

/// Little-endian numbers, one after the other; after the end all are 0 and ok() is false.
class Cursor {
 public:
  explicit Cursor(BytesView bytes) : bytes_(bytes) {}

  std::uint8_t byte() {
    if (at_ >= bytes_.size()) {
      ok_ = false;
      return 0;
    }
    return static_cast<std::uint8_t>(bytes_[at_++]);
  }
  std::uint16_t word() {
    const unsigned low = byte();
    return static_cast<std::uint16_t>(low | (static_cast<unsigned>(byte()) << 8U));
  }
  int signed_word() { return static_cast<std::int16_t>(word()); }

  [[nodiscard]] bool ok() const { return ok_; }
  [[nodiscard]] std::size_t left() const { return bytes_.size() - at_; }

 private:
  BytesView bytes_;
  std::size_t at_ = 0;
  bool ok_ = true;
};

/// Gripper, analog port and value; digital ports; the voltage again, with more room; charging; the turn's speed.
void read_tail(Cursor& cursor, ArcosSip& sip) {
  constexpr std::size_t kTail = 3 + 2 + 2 + 1 + 2;
  if (cursor.left() >= 5) {
    for (int i = 0; i < 3; ++i) cursor.byte();
    sip.digital_in = cursor.byte();
    sip.digital_out = cursor.byte();
  }
  if (cursor.left() < kTail - 5) return;
  if (const int tenths = cursor.signed_word(); tenths > 0) sip.battery = tenths / 10.0;
  cursor.byte();
  sip.rotation = cursor.signed_word() / 10.0;
}

constexpr unsigned kCounter = 0x7fffU;  ///< the counters of x and y have 15 bits; the 16th tells nothing

/// -16384 to 16383: a robot 1 mm behind its origin counts 32767.
int signed_of(unsigned word) {
  const auto turn = static_cast<int>(word & kCounter);
  return turn < 0x4000 ? turn : turn - 0x8000;
}

/// From one packet to the next.
int way(std::uint16_t from, std::uint16_t to) {
  return signed_of(static_cast<unsigned>(to) - static_cast<unsigned>(from));
}

/// Of the values that the word may stand for, the one nearest to `last`.
double nearest_to(double last, std::uint16_t word) {
  constexpr double kTurn = 0x8000;
  return signed_of(word) + kTurn * std::round((last - signed_of(word)) / kTurn);
}

bool near_origin(const ArcosSip& sip) {
  return std::abs(signed_of(sip.x)) <= kNearOrigin && std::abs(signed_of(sip.y)) <= kNearOrigin;
}

}  // namespace

bool ArcosSip::is_still() const {
  return std::abs(left) <= kStandingSpeed && std::abs(right) <= kStandingSpeed;
}

std::optional<ArcosSip> read_arcos_sip(const ArcosPacket& packet) {
  if (packet.type != kArcosStopped && packet.type != kArcosMoving) return std::nullopt;
  Cursor cursor(packet.contents);
  ArcosSip sip;
  sip.moving = packet.type == kArcosMoving;
  sip.x = cursor.word();
  sip.y = cursor.word();
  sip.heading = std::remainder(cursor.signed_word() * kDegreesPerUnit, 360);
  sip.left = cursor.signed_word();
  sip.right = cursor.signed_word();
  sip.battery = cursor.byte() / 10.0;
  sip.stall = cursor.word();
  cursor.word();  // the setpoint of its heading
  sip.flags = cursor.word();
  sip.compass = 2 * cursor.byte();
  for (int count = cursor.byte(); count > 0 && cursor.ok(); --count) {
    cursor.byte();  // a sonar disc
    cursor.word();  // its range
  }
  if (!cursor.ok()) return std::nullopt;
  read_tail(cursor, sip);
  return sip;
}

void ArcosOdometry::update(const ArcosSip& sip) {
  if (!known_ || (origin_comes_ && near_origin(sip))) {
    set(sip);
  } else {
    x_ += way(last_x_, sip.x);
    y_ += way(last_y_, sip.y);
  }
  last_x_ = sip.x;
  last_y_ = sip.y;
}

void ArcosOdometry::set(const ArcosSip& sip) {
  // A robot far out is where it was when the last connection ended; one at its origin was switched on again, or reset.
  const bool origin = near_origin(sip);
  jump_ = origin && !known_ ? std::hypot(x_ - signed_of(sip.x), y_ - signed_of(sip.y)) : 0;
  x_ = origin ? signed_of(sip.x) : nearest_to(x_, sip.x);
  y_ = origin ? signed_of(sip.y) : nearest_to(y_, sip.y);
  known_ = true;
  origin_comes_ = false;
}

}  // namespace trb::drivers
