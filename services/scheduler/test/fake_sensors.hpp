// The sensor-bus of a node, for tests: each sensor tells its values in turn, and the last one for ever.
#pragma once

#include <map>
#include <string>
#include <vector>

#include "proto/body.hpp"

namespace trb::scheduler::test {

struct FakeSensor {
  SensorInfo info;
  std::vector<SensorReading> values;
  std::size_t asked = 0;
};

class FakeSensors {
 public:
  /// A thermometer in degC; a sensor of that name is replaced.
  FakeSensor& plug(const std::string& name, std::vector<double> degrees, const std::string& identity = "");
  void unplug(const std::string& name) { sensors_.erase(name); }
  FakeSensor& operator[](const std::string& name) { return sensors_.at(name); }
  [[nodiscard]] std::vector<SensorInfo> infos() const;
  /// A SensorReading or a Nack.
  Body answer(const SensorRead& read);

  bool hangs = false;  ///< answers nothing

 private:
  std::map<std::string, FakeSensor> sensors_;
};

}  // namespace trb::scheduler::test
