#include "services/scheduler/core/run/inquiry.hpp"

#include <algorithm>
#include <tuple>

#include "common/base/errc.hpp"

namespace trb::scheduler {
namespace {

constexpr Duration kLookup = std::chrono::seconds(2);
constexpr double kRead_s = 5;  // within this the sensor has to send its next value; then it is asked again
constexpr Duration kRead = std::chrono::seconds(6);

struct Found {
  const Route* route = nullptr;
  const SensorInfo* sensor = nullptr;
  const Route* rival = nullptr;  ///< has the same serial number, and is as good a choice
};

/// Smaller is the better choice: a node that can be reached, a sensor that sends values, the node that the condition
/// names (another may claim to have what still is there). Of equals the smaller id is asked, unless it is a serial
/// number: there is one such device, so one of them is wrong.
auto rank(const Found& found, const Condition& condition) {
  const bool away = found.route->state == "OFFLINE" || found.route->state == "CONNECTION_BROKEN";
  return std::tuple(away, found.sensor->state != SensorState::ok, found.route->id != condition.of);
}

Found find(const RouteTable& table, const Condition& condition) {
  Found best;
  const bool bound = !condition.of.empty() && condition.identity.empty();
  for (const Route& route : table.routes) {
    if (bound && route.id != condition.of) continue;
    const Found found{&route, find_sensor(route.profile.plugged, condition)};
    if (found.sensor == nullptr) continue;
    const bool better = best.sensor == nullptr || rank(found, condition) < rank(best, condition);
    const bool equal = !better && rank(found, condition) == rank(best, condition);
    if (equal && !condition.identity.empty()) best.rival = &route;
    if (better || (equal && condition.identity.empty() && route.id < best.route->id)) best = found;
  }
  return best;
}

std::string refusal_text(const Nack& nack, const std::string& node) {
  for (const Errc away : {Errc::peer_unreachable, Errc::peer_expired, Errc::unknown_target}) {
    if (nack.code == errc_name(away) && nack.what.ends_with("not delivered")) return "'" + node + "' cannot be reached";
  }
  if (nack.code == errc_name(Errc::no_service)) return "no sensor-bus runs on '" + node + "'";
  return "'" + node + "' says " + nack.code + ": " + nack.what;
}

}  // namespace

bool Inquiry::take_update() {
  return std::exchange(updated_, false);
}

void Inquiry::restart(Now now) {
  next_ = now.mono;
  signature_.restart(now);
  if (phase_ != InquiryPhase::signing) phase_ = InquiryPhase::waiting;
}

void Inquiry::try_again(const std::string& why, Now now) {
  phase_ = InquiryPhase::waiting;
  obstacle_ = (sensor_text(condition_) + ": " + why).substr(0, 512);
  updated_ = true;
  next_ = now.mono + back_off_.next();
}

void Inquiry::tick(Now now, Outbox& out) {
  if (phase_ == InquiryPhase::signing) return signature_.tick(self_, now, out);
  if (next_ > now.mono) return;
  if (phase_ == InquiryPhase::looking) return try_again("the router does not say who has it", now);
  if (phase_ == InquiryPhase::asked) return try_again("'" + node_ + "' does not answer", now);
  phase_ = InquiryPhase::looking;
  next_ = now.mono + kLookup;
  out.request(self_, RouteListRequest{});
}

void Inquiry::on(const RouteTable& table, Now now, Outbox& out) {
  if (phase_ != InquiryPhase::looking) return;
  const Found found = find(table, condition_);
  if (found.sensor == nullptr) return try_again("no such sensor is plugged in", now);
  if (found.rival != nullptr) {
    node_.clear();  // nor counts a late answer of either
    return try_again("'" + found.route->id + "' and '" + found.rival->id +
                         "' both say that they have it: unplug one, or name the node in the condition's \"of\"",
                     now);
  }
  phase_ = InquiryPhase::asked;
  next_ = now.mono + kRead;
  node_ = found.route->id;
  sensor_ = found.sensor->name;
  out.request(node_, SensorRead{sensor_, condition_.identity, kRead_s});
}

void Inquiry::on_refusal(const Nack& nack, const std::string& from, Now now) {
  if (phase_ != InquiryPhase::asked || nack.subtype != SensorRead::kSubtype) return;
  const bool undelivered = from == self_ && nack.target == node_;
  if (from != node_ && !undelivered) return;
  // It may send a value only now and then: whoever waits for that does not pause for long.
  if (nack.code == errc_name(Errc::timeout)) back_off_.reset();
  try_again(refusal_text(nack, node_), now);
}

bool Inquiry::on(const SensorReading& reading, const std::string& from, Now now) {
  // A late answer is one, too: it was measured after the condition could be evaluated.
  const bool answer = phase_ != InquiryPhase::signing && from == node_ && reading.watch == 0 &&
                      reading.sensor == sensor_ &&
                      (condition_.identity.empty() || reading.identity == condition_.identity);
  if (!answer) return false;
  const Status believed = believe(condition_, reading);
  if (!believed) try_again(believed.error().what, now);
  return believed.ok();
}

void Inquiry::sign(Bytes choice, Now now, Outbox& out) {
  phase_ = InquiryPhase::signing;
  signature_ = Signature(kSignedChoice, std::move(choice), now);
  signature_.tick(self_, now, out);
}

}  // namespace trb::scheduler
