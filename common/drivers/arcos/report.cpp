#include "common/drivers/arcos/report.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "common/drivers/text/number_text.hpp"

namespace trb::drivers {
namespace {

/// A 12 V lead battery at rest; under 11 V a Pioneer switches itself off.
constexpr double kEmpty = 11.0;
constexpr double kFull = 12.8;

constexpr std::uint32_t kMotorsOff = 1U << 16U;
constexpr std::uint32_t kStopButton = 1U << 17U;

using Sip = const ArcosSip&;
using Place = const ArcosOdometry&;

/// The function for each field, in the order of ArcosField.
constexpr std::array<double (*)(Sip, Place), 17> kTellers = {
    [](Sip, Place place) -> double { return place.x(); },
    [](Sip, Place place) -> double { return place.y(); },
    [](Sip sip, Place) -> double { return sip.heading; },
    [](Sip sip, Place) -> double { return (sip.left + sip.right) / 2.0; },
    [](Sip sip, Place) -> double { return sip.rotation; },
    [](Sip sip, Place) -> double { return sip.left; },
    [](Sip sip, Place) -> double { return sip.right; },
    [](Sip sip, Place) -> double { return sip.battery; },
    [](Sip sip, Place) -> double { return std::clamp((sip.battery - kEmpty) / (kFull - kEmpty), 0.0, 1.0) * 100; },
    [](Sip sip, Place) -> double { return sip.stalled() ? 1 : 0; },
    [](Sip sip, Place) -> double { return sip.stall & 0xfefeU; },
    [](Sip sip, Place) -> double { return sip.motors() ? 1 : 0; },
    [](Sip sip, Place) -> double { return sip.emergency_stop() ? 1 : 0; },
    [](Sip sip, Place) -> double { return sip.moving ? 1 : 0; },
    [](Sip sip, Place) -> double { return sip.compass; },
    [](Sip sip, Place) -> double { return sip.digital_in; },
    [](Sip sip, Place) -> double { return sip.digital_out; },
};
static_assert(kTellers.size() == static_cast<std::size_t>(ArcosField::digital_out) + 1);

double number_of(ArcosField field, Sip sip, Place place) {
  return kTellers[static_cast<std::size_t>(field)](sip, place);
}

bool is_bool(ArcosField field) {
  return field == ArcosField::stalled || field == ArcosField::motors || field == ArcosField::emergency_stop ||
         field == ArcosField::moving;
}

/// "2, 3" of the bits 1 to 7.
std::string contacts(unsigned bits) {
  std::string out;
  for (int i = 1; i <= 7; ++i) {
    if ((bits >> static_cast<unsigned>(i) & 1U) != 0) out += (out.empty() ? "" : ", ") + std::to_string(i);
  }
  return out;
}

void add(std::string& text, const std::string& more) {
  text += (text.empty() ? "" : "; ") + more;
}

std::string stall_text(unsigned stall) {
  std::string text;
  const bool left = (stall & 1U) != 0;
  const bool right = (stall & 0x100U) != 0;
  if (left || right)
    add(text, left && right ? "both wheels stalled" : left ? "left wheel stalled" : "right wheel stalled");
  const std::string front = contacts(stall);
  const std::string rear = contacts(stall >> 8U);
  if (!front.empty()) add(text, "front bumper " + front);
  if (!rear.empty()) add(text, "rear bumper " + rear);
  return text;
}

}  // namespace

RobotValue arcos_value(const std::vector<ArcosField>& fields, const ArcosSip& sip, const ArcosOdometry& place,
                       Now now) {
  RobotValue value;
  value.heard = now.mono;
  for (const ArcosField field : fields) {
    const double number = std::round(number_of(field, sip, place) * 10) / 10 + 0.0;  // no -0
    value.numbers.push_back(number);
    value.json += (value.json.empty() ? "" : ",") + number_text(number);
  }
  if (fields.size() > 1) value.json = "[" + value.json + "]";
  if (fields.size() == 1 && is_bool(fields.front())) value.json = value.numbers.front() != 0 ? "true" : "false";
  return value;
}

std::optional<FaultSaid> ArcosFaults::update(const ArcosSip& sip, bool motors_wanted) {
  std::uint32_t wrong = sip.stall;
  if (motors_wanted && !sip.motors()) wrong |= kMotorsOff;
  if (sip.emergency_stop()) wrong |= kStopButton;
  const std::uint32_t fresh = wrong & ~known_;
  known_ = wrong;
  if (fresh == 0) return std::nullopt;
  std::string text = stall_text(wrong & 0xffffU);
  if ((wrong & kMotorsOff) != 0) add(text, "the motors are off");
  if ((wrong & kStopButton) != 0) add(text, "the STOP button is pressed");
  const Severity severity = (fresh & kStopButton) != 0  ? Severity::fatal
                            : (fresh & kMotorsOff) != 0 ? Severity::critical
                                                        : Severity::urgent;
  return FaultSaid{"", severity, text, severity < Severity::critical ? "" : kArcosHalted};
}

std::string arcos_hindrance(const ArcosSip& sip) {
  std::string text = sip.stalled() ? stall_text(sip.stall) : "";
  if (!sip.motors()) add(text, "the motors are off");
  if (sip.emergency_stop()) add(text, "the STOP button is pressed");
  return text;
}

}  // namespace trb::drivers
