#include "services/virtual-robots/pioneer/flash_settings.hpp"

namespace trb::virtual_robots::pioneer {
namespace {

enum SettingNumber : int {
  kRotKp = 82,
  kRotKv = 83,
  kRotKi = 84,
  kTransKp = 85,
  kTransKv = 86,
  kTransKi = 87,
  kRevCount = 88,
  kTicksMm = 93,
};

}  // namespace

bool FlashSettings::take(int command, int value) {
  const auto set = [value](int& setting) {
    setting = value;
    return true;
  };
  switch (command) {
    case kRotKp:
      return set(turn.proportional);
    case kRotKv:
      return set(turn.derivative);
    case kRotKi:
      return set(turn.integral);
    case kTransKp:
      return set(drive.proportional);
    case kTransKv:
      return set(drive.derivative);
    case kTransKi:
      return set(drive.integral);
    case kRevCount:
      return set(encoder_revolution);
    case kTicksMm:
      return set(encoder_ticks_mm);
    default:
      return false;
  }
}

}  // namespace trb::virtual_robots::pioneer
