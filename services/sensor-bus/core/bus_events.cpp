// What the D-Bus reports: that it is there or not, and signals.
#include "services/sensor-bus/core/sensor_bus_core.hpp"

namespace trb::sensor {

void SensorBusCore::on_bus_events(const std::vector<BusEvent>& events, Now now, Outbox& out) {
  for (const BusEvent& one : events) {
    std::visit([&](const auto& told) { on_bus(told, now, out); }, one);
  }
  settle(now, out);
}

void SensorBusCore::on_bus(const BusUp& up, Now, Outbox& out) {
  bus_up_ = true;
  bus_fault_ = up.note;
  rules_.clear();
  asked_changed_ = true;
  out.log(LogLevel::info, "bus_up", "the D-Bus is there" + (up.note.empty() ? "" : ": " + up.note));
  for (const auto& [name, sensor] : sensors_.all()) announce(sensor);
}

void SensorBusCore::on_bus(const BusDown& down, Now, Outbox& out) {
  if (bus_up_ || down.reason != bus_fault_) out.log(LogLevel::warning, "bus_down", down.reason);
  bus_up_ = false;
  bus_fault_ = down.reason;
}

/// False if no program may feed that name.
bool SensorBusCore::from_program(const std::string& name, Now now, Outbox& out) {
  const bool is_new = sensors_.find(name) == nullptr;
  const auto sensor = sensors_.fed(name, now.mono);
  if (!sensor) {
    out.count("refused.signal_" + std::string(errc_name(sensor.error().code)));
    out.log(LogLevel::warning, "signal_refused", sensor.error().text());
    return false;
  }
  if (is_new) {
    out.log(LogLevel::info, "sensor_fed", name + " is fed by a program");
    announce(**sensor);
  }
  return true;
}

void SensorBusCore::on_bus(const ProgramHeard& heard, Now now, Outbox& out) {
  from_program(heard.name, now, out);
}

void SensorBusCore::on_bus(const SignalHeard& heard, Now now, Outbox& out) {
  if (heard.own) {
    const Sensor* sensor = sensors_.find(heard.name);
    if (sensor == nullptr || sensor->fed()) return;  // unplugged in the meantime
  } else {
    if (!from_program(heard.name, now, out)) return;
    sensors_.set_value(heard.name, heard.value, now.mono, now.mono);
  }
  deliver(heard.name, reading_of(heard.name, heard.value, now), now, out);
}

void SensorBusCore::on_bus(const SignalRefused& refused, Now, Outbox& out) {
  out.count(refused.counter);
  out.log(LogLevel::warning, "signal_refused", refused.text);
}

}  // namespace trb::sensor
