// Runs the core: what the router, the devices and the D-Bus tell becomes its steps; what it wants done after each of
// them goes to the D-Bus and the devices.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "common/service/service.hpp"
#include "services/sensor-bus/core/sensor_bus_core.hpp"

namespace trb::sensor {

class SensorBusShell final : public Core, public DeviceListener {
 public:
  SensorBusShell(Service& service, SensorBusCore& core) : service_(service), core_(core) {}

  /// Who carries out what the core wants. Until then it is dropped.
  void to_bus(std::function<void(std::vector<Effect>)> carry_out) { bus_ = std::move(carry_out); }
  void to_devices(DeviceControl& devices) { devices_ = &devices; }

  void on_welcome(const NodeIdentity& node, Now now, Outbox& out) override;
  void on(const Inbound& message, Now now, Outbox& out) override;
  void tick(Now now, Outbox& out) override;
  [[nodiscard]] std::optional<MonotonicTime> next_deadline() const override { return core_.next_deadline(); }

  void on_plugged(const PluggedSensor& sensor) override;
  void on_unplugged(const std::string& key) override;
  void on_sample(const Sample& sample) override;
  void on_picture(const Picture& picture) override;
  void on_unknown(const std::vector<UnknownDevice>& devices) override;

  void on_bus_events(const std::vector<BusEvent>& events);

 private:
  void step(const std::function<void(Now, Outbox&)>& effect);
  void carry_out();

  Service& service_;
  SensorBusCore& core_;
  std::function<void(std::vector<Effect>)> bus_;
  DeviceControl* devices_ = nullptr;
};

}  // namespace trb::sensor
