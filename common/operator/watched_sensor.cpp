#include "common/operator/watched_sensor.hpp"

#include <cstring>

#include "common/operator/read_sensor.hpp"

namespace trb::op {
namespace {

constexpr double kLease_s = 10;
constexpr Duration kRenew = std::chrono::seconds(3);
constexpr Duration kLookForSensor = std::chrono::milliseconds(500);
constexpr Duration kFirstLook = std::chrono::milliseconds(100);  ///< after it was lost

}  // namespace

template <class Call>
auto WatchedSensor::while_alive(Call call) {
  return [alive = std::weak_ptr<int>(alive_), call = std::move(call)](auto&&... values) {
    if (!alive.expired()) call(std::forward<decltype(values)>(values)...);
  };
}

WatchedSensor::WatchedSensor(Session& session, SensorWish wish, double every_s, Events events)
    : session_(session), wish_(std::move(wish)), every_s_(every_s), events_(std::move(events)) {
  const Bytes drawn = session_.random_bytes(sizeof number_);
  std::memcpy(&number_, drawn.data(), sizeof number_);
}

void WatchedSensor::begin(const Callback<Done>& begun) {
  const auto found = [this, begun](const FoundSensor& sensor) { order_first(sensor, begun); };
  look_up_sensor(session_, wish_, on_success<FoundSensor>(begun, while_alive(found)));
}

void WatchedSensor::order_first(const FoundSensor& found, const Callback<Done>& begun) {
  sensor_ = found;
  const SensorInfo& info = sensor_.info;
  if (info.kind == "image")
    return begun(fail(Errc::bad_value, info.name + " tells pictures", "use trb sensor read --save FILE"));
  // From now on it is this very device, wherever it is plugged in, possibly under another name.
  if (!info.identity.empty() && wish_.node.empty()) wish_ = {info.kind, "", info.identity};
  const auto answered = [this, begun](const Message&) {
    here_ = true;
    renew_in(kRenew);
    begun(Done{});
  };
  session_.request(order_of(kLease_s), on_success<Message>(begun, while_alive(answered)));
}

void WatchedSensor::receive(const Message& message) {
  if (message.subtype == SensorReading::kSubtype && message.source == sensor_.node) {
    const auto reading = decode<SensorReading>(message.data);
    if (reading && reading->watch == number_) events_.value(message.source, *reading);
  } else if (message.subtype == Nack::kSubtype && here_) {
    if (const auto nack = decode<Nack>(message.data)) lose(*nack);
  }
}

void WatchedSensor::end() {
  if (here_) order(0);
  here_ = false;
  alive_.reset();
}

Send WatchedSensor::order_of(double lease_s) const {
  return {.type = MessageType::request,
          .target = sensor_.node,
          .body = SensorWatch{sensor_.info.name, sensor_.info.identity, number_, every_s_, lease_s}};
}

void WatchedSensor::order(double lease_s) {
  const auto refused = [this](const Message* answer) {
    if (answer != nullptr) receive(*answer);
  };
  (void)session_.send(order_of(lease_s), kAnswerWait, while_alive(refused));
}

void WatchedSensor::renew_in(Duration wait) {
  const auto due = [this, renewal = ++renewals_] {
    if (renewal == renewals_) renew();
  };
  session_.after(wait, while_alive(due));
}

void WatchedSensor::renew() {
  if (!here_) return look();
  for_room_.reset();
  order(kLease_s);
  renew_in(kRenew);
}

void WatchedSensor::look() {
  const auto found = [this](const Result<FoundSensor>& sensor) {
    if (!sensor || !sensor->reached()) return renew_in(kLookForSensor);
    sensor_ = *sensor;
    here_ = true;
    order(kLease_s);
    renew_in(kRenew);
    events_.note("asks " + sensor_.node + " for " + sensor_.info.name);
  };
  look_up_sensor(session_, wish_, while_alive(found));
}

void WatchedSensor::lose(const Nack& why) {
  here_ = false;
  renew_in(why.code == errc_name(Errc::queue_full) ? for_room_.next() : kFirstLook);
  events_.note(why.what + "; looks for it");
}

}  // namespace trb::op
