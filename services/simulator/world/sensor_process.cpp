#include "services/simulator/world/sensor_process.hpp"

namespace trb::world {
namespace {

constexpr Duration kDBus = std::chrono::microseconds(300);   ///< a signal's way
constexpr Duration kReading = std::chrono::milliseconds(5);  ///< what reading a sensor takes
constexpr Duration kUp = std::chrono::milliseconds(20);      ///< until the D-Bus is there and the devices are found

/// Sensors of one identity are of one device.
std::string key_of(const PlannedSensor& sensor, std::size_t index) {
  const std::string number = std::to_string(index);
  return (sensor.info.identity.empty() ? number : sensor.info.identity) + "#" + number;
}

std::size_t index_of(const std::string& key) {
  return std::stoul(key.substr(key.rfind('#') + 1));
}

ServiceSettings service_settings(const SensorSettings& settings, std::function<void()> after_sends) {
  ServiceSettings out;
  out.name = "sensor-bus";
  out.subtypes = sensor::SensorBusCore::Taken::subtypes();
  out.hears = {std::string(PeerExpired::kSubtype)};
  out.instance = settings.instance;
  out.after_sends = std::move(after_sends);
  out.meddler = settings.meddler;
  return out;
}

}  // namespace

SensorProcess::SensorProcess(SensorSettings settings, Bus& bus, Events& events, const Clock& clock, Dice& dice)
    : settings_(std::move(settings)),
      events_(events),
      clock_(clock),
      core_(settings_.node),
      service_(service_settings(settings_, [this] { carry_out(); }), core_, bus, events, clock, dice) {
  events_.after(kUp, life_, [this] { plug(); });
}

void SensorProcess::plug() {
  service_.step([this](Now now, Outbox& out) { core_.on_bus_events({sensor::BusUp{}}, now, out); });
  for (std::size_t i = 0; i < settings_.sensors.size(); ++i) {
    const PlannedSensor& one = settings_.sensors[i];
    service_.step([&](Now now, Outbox& out) { core_.on_plugged({key_of(one, i), one.info, one.every_s}, now, out); });
    read_in_turn(i);
  }
}

void SensorProcess::read_in_turn(std::size_t index) {
  read(index);
  events_.after(seconds(settings_.sensors[index].every_s), life_, [this, index] { read_in_turn(index); });
}

void SensorProcess::read(std::size_t index) {
  events_.after(kReading, life_, [this, index] {
    const PlannedSensor& from = settings_.sensors[index];
    const Measured value = from.course.at(settings_.run_seconds());
    const Now now = clock_.now();
    sensor::Sample sample{.key = key_of(from, index), .text = {}, .time = now.utc, .measured = now.mono, .error = {}};
    if (const auto* number = std::get_if<double>(&value)) {
      sample.number = *number;
    } else if (const auto* text = std::get_if<std::string>(&value)) {
      sample.is_text = true;
      sample.text = *text;
    } else {
      sample.error = fail(Errc::io_error, "cannot be read", "wait until it can");
    }
    service_.step([&](Now at, Outbox& out) { core_.on_sample(sample, at, out); });
  });
}

void SensorProcess::carry_out() {
  for (const sensor::Effect& effect : core_.take_effects()) carry_out(effect);
}

/// What only people look at (objects, introspection) and pictures have no part here.
void SensorProcess::carry_out(const sensor::Effect& effect) {
  if (const auto* rule = std::get_if<sensor::Subscribe>(&effect)) heard_.insert(rule->name);
  if (const auto* rule = std::get_if<sensor::Unsubscribe>(&effect)) heard_.erase(rule->name);
  if (const auto* wanted = std::get_if<sensor::ReadNow>(&effect)) read(index_of(wanted->key));
  if (const auto* signal = std::get_if<sensor::EmitValue>(&effect)) emit(*signal);
}

void SensorProcess::emit(const sensor::EmitValue& signal) {
  if (!heard_.contains(signal.name)) return;
  events_.after(kDBus, life_, [this, signal] {
    service_.step([&](Now now, Outbox& out) {
      core_.on_bus_events({sensor::SignalHeard{signal.name, true, signal.value}}, now, out);
    });
  });
}

}  // namespace trb::world
