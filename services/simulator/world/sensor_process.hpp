// A node's sensor-bus: the real core; in place of its shell a D-Bus on which only this node talks, and sensors that are
// read as their readers' threads would.
#pragma once

#include <memory>
#include <set>
#include <string>
#include <vector>

#include "services/sensor-bus/core/sensor_bus_core.hpp"
#include "services/simulator/world/sensor_plan.hpp"
#include "services/simulator/world/service_process.hpp"

namespace trb::world {

struct SensorSettings {
  std::string node;
  std::vector<PlannedSensor> sensors;
  std::function<double()> run_seconds;  ///< since the run's submission; 0 before it
  std::uint64_t instance = 0;
  const Meddler* meddler = nullptr;
};

class SensorProcess {
 public:
  SensorProcess(SensorSettings settings, Bus& bus, Events& events, const Clock& clock, Dice& dice);
  SensorProcess(const SensorProcess&) = delete;
  SensorProcess& operator=(const SensorProcess&) = delete;

  [[nodiscard]] std::uint64_t malformed() const { return service_.malformed(); }

 private:
  void plug();
  void read_in_turn(std::size_t index);
  void read(std::size_t index);
  void carry_out();
  void carry_out(const sensor::Effect& effect);
  void emit(const sensor::EmitValue& signal);

  SensorSettings settings_;
  Events& events_;
  const Clock& clock_;
  std::shared_ptr<char> life_ = std::make_shared<char>();
  sensor::SensorBusCore core_;
  std::set<std::string> heard_;  ///< the signals that the core has subscribed to
  ServiceProcess service_;
};

}  // namespace trb::world
