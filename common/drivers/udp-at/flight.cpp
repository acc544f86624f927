#include "common/drivers/udp-at/flight.hpp"

#include <cmath>
#include <utility>

namespace trb::drivers {
namespace {

constexpr std::uint32_t kReference = 0x11540000;  // bits 18, 20, 22, 24 and 28 are always set
constexpr std::uint32_t kTakeOffBit = 1U << 9;
constexpr std::uint32_t kEmergencyBit = 1U << 8;

/// Navdata read this long after a command is certainly newer than it.
constexpr Duration kNavdataPeriod = std::chrono::milliseconds(100);
constexpr Duration kLeavesGround = std::chrono::seconds(3);
constexpr Duration kToggles = std::chrono::milliseconds(1500);
constexpr double kDefaultMotion_s = 1;
constexpr double kStanding_m_s = 0.1;

std::string why(const std::string& what, const ArNavdata& drone) {
  const std::string problems = ar_problems(drone.state);
  const std::string battery = drone.demo ? " (battery " + std::to_string(drone.demo->battery) + " %)" : "";
  return what + battery + (problems.empty() ? "" : ": " + problems);
}

}  // namespace

bool at_is_still(const ArNavdata& drone) {
  if (!drone.demo || !drone.has(kArFlying)) return true;
  const bool level = std::hypot(drone.demo->vx, drone.demo->vy) < kStanding_m_s;
  return level && (drone.control() == ArControl::landing || std::abs(drone.demo->vz) < kStanding_m_s);
}

void AtFlight::follow(const ArNavdata& drone) {
  fly_ = drone.has(kArFlying) && drone.control() != ArControl::landing;
  motion_.clear();
  task_.reset();
}

void AtFlight::begin(Token token, const std::string& subtype, const AtOrder& order, Now now, const DriverOut& out) {
  end_badly(Errc::conflict, "'" + subtype + "' took its place", "", out);
  motion_.clear();
  task_ = Task{token, subtype, order.action, now.mono, {}};
  if (order.action == AtAction::take_off) fly_ = true;
  if (order.action == AtAction::land || toggles()) fly_ = false;
  if (order.action == AtAction::move) motion_ = order.arguments;
  const bool lasts = order.action == AtAction::move || order.action == AtAction::hover;
  if (!lasts) return;
  const double duration_s = order.duration_s == 0 ? kDefaultMotion_s : order.duration_s;
  task_->until = now.mono + seconds(duration_s);
  // Hovering without a duration is how every motion ends: it is not reported.
  if (order.action == AtAction::hover && order.duration_s == 0) task_.reset();
}

void AtFlight::stop(const ArNavdata& drone, bool land) {
  motion_.clear();
  if (land || !drone.airborne()) fly_ = false;
  if (!toggles()) task_.reset();
}

void AtFlight::lose(const std::string& reason, const DriverOut& out) {
  end_badly(Errc::robot_offline, "the drone's link was lost: " + reason, "look at the drone", out);
  motion_.clear();
}

void AtFlight::on_navdata(const ArNavdata& drone, Now now, const DriverOut& out) {
  check_emergency(drone, now, out);
  if (task_ && now.mono - task_->began < kNavdataPeriod) return;
  if (does(AtAction::take_off) && drone.airborne()) return end_well(out);
  if (does(AtAction::land) && drone.landed()) return end_well(out);
  check_ground(drone, now, out);
}

void AtFlight::check_emergency(const ArNavdata& drone, Now now, const DriverOut& out) {
  const bool cut = drone.has(kArEmergency);
  if (toggles()) {
    const bool young = now.mono - task_->began < kNavdataPeriod;
    if (!young && cut == does(AtAction::emergency)) {
      out.emit(HandedOver{task_->token});
      end_well(out);
    }
    return;
  }
  if (!cut) return;
  fly_ = false;
  motion_.clear();
  if (!does(AtAction::land)) {
    end_badly(Errc::robot_error, why("the drone's motors were cut", drone), "look at the drone, then recover it", out);
  }
}

/// A drone that does not take off, or has come down by itself, is no longer ordered to be in the air.
void AtFlight::check_ground(const ArNavdata& drone, Now now, const DriverOut& out) {
  const bool down = drone.landed() || drone.control() == ArControl::landing;
  if (!fly_ || !down) return;
  const bool begins = does(AtAction::take_off);
  if (begins && now.mono - task_->began < kLeavesGround) return;
  fly_ = false;
  motion_.clear();
  const char* const what = begins ? "the drone did not take off within 3 s" : "the drone came down by itself";
  end_badly(Errc::robot_error, why(what, drone), "look at the drone and its battery", out);
}

void AtFlight::tick(Now now, const DriverOut& out) {
  if (!task_) return;
  if (task_->until && now.mono >= *task_->until) {
    motion_.clear();
    return end_well(out);
  }
  if (toggles() && now.mono - task_->began >= kToggles) {
    end_badly(Errc::timeout, "the drone did not confirm '" + task_->subtype + "' within 1.5 s", "look at the drone",
              out);
  }
}

std::string AtFlight::reference() const {
  const std::uint32_t bits = kReference | (fly_ ? kTakeOffBit : 0) | (toggles() ? kEmergencyBit : 0);
  return std::to_string(bits);
}

void AtFlight::end_well(const DriverOut& out) {
  const Task ended = *std::exchange(task_, std::nullopt);
  out.out.count("from_robot.done");
  out.emit(Ended{ended.token, true, {}});
}

void AtFlight::end_badly(Errc code, const std::string& what, const std::string& hint, const DriverOut& out) {
  const auto ended = std::exchange(task_, std::nullopt);
  if (ended) out.emit(Refused{ended->token, fail(code, what, hint)});
}

}  // namespace trb::drivers
