#include "services/sensor-bus/io/sensor_bus_shell.hpp"

namespace trb::sensor {

void SensorBusShell::on_welcome(const NodeIdentity& node, Now now, Outbox& out) {
  core_.on_welcome(node, now, out);
  carry_out();
}

void SensorBusShell::on(const Inbound& message, Now now, Outbox& out) {
  core_.on(message, now, out);
  carry_out();
}

void SensorBusShell::tick(Now now, Outbox& out) {
  core_.tick(now, out);
  carry_out();
}

void SensorBusShell::step(const std::function<void(Now, Outbox&)>& effect) {
  service_.step(effect);
  carry_out();
}

void SensorBusShell::on_plugged(const PluggedSensor& sensor) {
  step([&](Now now, Outbox& out) { core_.on_plugged(sensor, now, out); });
}

void SensorBusShell::on_unplugged(const std::string& key) {
  step([&](Now now, Outbox& out) { core_.on_unplugged(key, now, out); });
}

void SensorBusShell::on_sample(const Sample& sample) {
  step([&](Now now, Outbox& out) { core_.on_sample(sample, now, out); });
}

void SensorBusShell::on_picture(const Picture& picture) {
  step([&](Now now, Outbox& out) { core_.on_picture(picture, now, out); });
}

void SensorBusShell::on_unknown(const std::vector<UnknownDevice>& devices) {
  step([&](Now, Outbox&) { core_.on_unknown(devices); });
}

void SensorBusShell::on_bus_events(const std::vector<BusEvent>& events) {
  step([&](Now now, Outbox& out) { core_.on_bus_events(events, now, out); });
}

void SensorBusShell::carry_out() {
  std::vector<Effect> to_bus;
  for (Effect& effect : core_.take_effects()) {
    if (const auto* read = std::get_if<ReadNow>(&effect)) {
      if (devices_ != nullptr) devices_->read_now(read->key);
    } else if (const auto* take = std::get_if<TakePicture>(&effect)) {
      if (devices_ != nullptr) devices_->take_picture(take->key);
    } else {
      to_bus.push_back(std::move(effect));
    }
  }
  if (!to_bus.empty() && bus_) bus_(std::move(to_bus));
}

}  // namespace trb::sensor
