#include "services/sensor-bus/core/sensor_bus_core.hpp"

#include <algorithm>

#include "proto/value.hpp"

namespace trb::sensor {
namespace {

using std::chrono::milliseconds;

/// Changes sent together: a hub with many devices is plugged in all at once.
constexpr Duration kGather = milliseconds(50);
/// A sensor whose state flaps does not keep the fleet busy.
constexpr Duration kGatherStates = std::chrono::seconds(1);

}  // namespace

void SensorBusCore::on_welcome(const NodeIdentity&, Now now, Outbox& out) {
  welcomed_ = true;
  tell_at_ = now.mono;
  settle(now, out);
}

void SensorBusCore::on(const Inbound& message, Now now, Outbox& out) {
  if (const auto* expired = get_if<PeerExpired>(&message.body); expired != nullptr && message.source == node_) {
    forget_node(expired->id);
  } else if (message.type == MessageType::request && message.wants_answer()) {
    on_request(message, now, out);
  } else if (message.reply_to == 0) {
    refuse_unexpected(message, out);
  }
  settle(now, out);
}

void SensorBusCore::on_request(const Inbound& asked, Now now, Outbox& out) {
  // Of a robot, or a person: the name of a sensor.
  if (const auto* name = get_if<Opaque>(&asked.body)) {
    return begin_read(asked, SensorRead{name->subtype, "", 0}, now, out);
  }
  const bool taken =
      Taken::dispatch(asked.body, Overloaded{[&](const SensorRead& body) { begin_read(asked, body, now, out); },
                                             [&](const SensorWatch& body) { order_watch(asked, body, now, out); },
                                             [&](const SensorSnapshot& body) { begin_picture(asked, body, now, out); },
                                             [&](const SensorListRequest& body) { send_table(asked, body, out); }});
  if (!taken) refuse_unexpected(asked, out);
}

void SensorBusCore::refuse_unexpected(const Inbound& message, Outbox& out) {
  out.count("refused.unexpected");
  out.nack(message,
           fail(Errc::bad_value, std::string(subtype_of(message.body)) + " is not for a sensor-bus in this way"));
}

void SensorBusCore::forget_node(const std::string& id) {
  const auto of_it = [&](const Requester& one) { return one.asked.source == id; };
  watches_.forget_node(id);
  asked_changed_ = std::erase_if(reads_, of_it) != 0 || asked_changed_;
  std::erase_if(pictures_, of_it);
}

void SensorBusCore::send_table(const Inbound& asked, const SensorListRequest& body, Outbox& out) const {
  SensorTable table{node_, sensors_.infos(), {}, cut_utf8(bus_fault_, 255)};
  if (body.unknown) table.unknown = unknown_;
  out.reply(asked, std::move(table));
}

// ---- the devices

void SensorBusCore::on_plugged(const PluggedSensor& plugged, Now now, Outbox& out) {
  const auto sensor = sensors_.plug(plugged, now.mono);
  if (!sensor) {
    out.count("refused.plugged_" + std::string(errc_name(sensor.error().code)));
    return out.log(LogLevel::warning, "sensor_refused", sensor.error().text());
  }
  const SensorInfo& info = (*sensor)->info;
  out.log(LogLevel::info, "sensor_plugged", info.name + " (" + info.kind + ") " + info.device + " at " + plugged.key);
  announce(**sensor);
  settle(now, out);
}

void SensorBusCore::on_unplugged(const std::string& key, Now now, Outbox& out) {
  if (const auto name = sensors_.unplug(key)) gone(*name, "was unplugged", out);
  settle(now, out);
}

void SensorBusCore::gone(const std::string& name, const std::string& why, Outbox& out) {
  out.log(LogLevel::info, "sensor_gone", name + " " + why);
  order(Withdraw{name});
  const Error error = fail(Errc::unknown_target, name + " " + why, "there are: " + sensors_.names());
  watches_.end_of(name, error, out);
  const auto is_over = [&](const Requester& one) {
    if (one.name != name) return false;
    refuse(one.asked, error, out);
    return true;
  };
  asked_changed_ = std::erase_if(reads_, is_over) != 0 || asked_changed_;
  std::erase_if(pictures_, is_over);
}

void SensorBusCore::announce(const Sensor& sensor) {
  order(Announce{sensor.info, sensor.value && sensor.value->is_text});
}

// ---- the fleet

void SensorBusCore::tick(Now now, Outbox& out) {
  expire(now, out);
  settle(now, out);
}

std::optional<MonotonicTime> SensorBusCore::next_deadline() const {
  auto next = earlier(sensors_.next_check(), watches_.next_deadline());
  if (welcomed_) next = earlier(next, tell_at_);
  for (const Requester& requester : reads_) next = earlier(next, requester.deadline);
  for (const Requester& requester : pictures_) next = earlier(next, requester.deadline);
  return next;
}

void SensorBusCore::settle(Now now, Outbox& out) {
  settle_rules();
  const Sensors::Change change = sensors_.take_change();
  if (change.list || change.state) {
    const Duration gather = change.list ? kGather : kGatherStates;
    tell_at_ = earlier(tell_at_, std::max(now.mono, told_at_ ? *told_at_ + gather : now.mono));
  }
  if (!welcomed_ || !tell_at_ || now.mono < *tell_at_) return;
  tell_at_.reset();
  told_at_ = now.mono;
  out.information(node_, NodeSensors{sensors_.infos()});
}

/// One rule for all who wait for a name; none that nobody waits for.
void SensorBusCore::settle_rules() {
  if (!(watches_.take_changed() || std::exchange(asked_changed_, false)) || !bus_up_) return;
  std::set<std::string> wanted = watches_.names();
  for (const Requester& read : reads_) wanted.insert(read.name);
  for (const std::string& name : rules_) {
    if (wanted.count(name) == 0) effects_.emplace_back(Unsubscribe{name});
  }
  for (const std::string& name : wanted) {
    if (rules_.count(name) == 0) effects_.emplace_back(Subscribe{name});
  }
  rules_ = std::move(wanted);
}

/// While the bus is down there is nothing to say to it.
void SensorBusCore::order(Effect effect) {
  const bool to_device = std::holds_alternative<ReadNow>(effect) || std::holds_alternative<TakePicture>(effect);
  if (bus_up_ || to_device) effects_.push_back(std::move(effect));
}

}  // namespace trb::sensor
