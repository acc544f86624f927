#include "services/scheduler/test/fake_sensors.hpp"

#include <algorithm>

namespace trb::scheduler::test {

FakeSensor& FakeSensors::plug(const std::string& name, std::vector<double> degrees, const std::string& identity) {
  FakeSensor& sensor = sensors_[name];
  sensor = {};
  sensor.info = {name, "temperature", "degC", identity, "", SensorState::ok, ""};
  for (const double value : degrees) {
    sensor.values.push_back({name, identity, "degC", false, value, "", 1, 0, "good", 0, 0});
  }
  return sensor;
}

std::vector<SensorInfo> FakeSensors::infos() const {
  std::vector<SensorInfo> out;
  for (const auto& [name, sensor] : sensors_) out.push_back(sensor.info);
  return out;
}

Body FakeSensors::answer(const SensorRead& read) {
  for (auto& [name, sensor] : sensors_) {
    const bool meant = read.identity.empty() ? name == read.sensor : sensor.info.identity == read.identity;
    if (meant) return sensor.values[std::min(sensor.asked++, sensor.values.size() - 1)];
  }
  return Nack{"unknown_target", "sensor_read", "", "no sensor '" + read.sensor + "' here", ""};
}

}  // namespace trb::scheduler::test
