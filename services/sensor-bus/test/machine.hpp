// A machine whose devices are the test's own, and the devices' side of the sensor-bus on it. To be run under
// umockdev-wrapper: libudev, /sys and /dev are the test's.
#pragma once

#include <doctest/doctest.h>
#include <umockdev.h>

#include <functional>
#include <map>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "common/service/test/loopless_service.hpp"
#include "services/sensor-bus/io/devices/devices.hpp"

namespace trb::sensor::test {

/// A loop that runs until what is waited for has come.
class FakeService final : public LooplessService {
 public:
  [[nodiscard]] std::uint64_t instance() const override { return 1; }
  void after_sends(std::function<void()>) override {}
  void watch(int fd, short events, std::function<void(short)> ready) override {
    watches_[fd] = {events, std::move(ready)};
  }
  void unwatch(int fd) override { watches_.erase(fd); }
  void timer(std::function<std::optional<MonotonicTime>()> next, std::function<void(Now)> tick) override {
    next_ = std::move(next);
    tick_ = std::move(tick);
  }
  void step(const Effect&) override {}

  [[nodiscard]] bool run_until(const std::function<bool()>& holds, double timeout_s = 60);

 private:
  void turn();

  std::map<int, std::pair<short, std::function<void(short)>>> watches_;
  std::function<std::optional<MonotonicTime>()> next_;
  std::function<void(Now)> tick_;
};

/// What the core would be told.
struct Heard final : DeviceListener {
  void on_plugged(const PluggedSensor& sensor) override;
  void on_unplugged(const std::string& key) override;
  void on_sample(const Sample& sample) override;
  void on_picture(const Picture& picture) override { pictures.push_back(picture); }
  void on_unknown(const std::vector<UnknownDevice>& devices) override { unknown = devices; }

  std::map<std::string, PluggedSensor> plugged;
  std::map<std::string, Sample> samples;
  std::map<std::string, Error> errors;
  std::map<std::string, int> counts;
  std::vector<Picture> pictures;
  std::vector<UnknownDevice> unknown;
  int times_plugged = 0;
};

using Words = std::vector<std::string>;  // name, value, name, value ...

/// A machine into which devices are plugged.
class Machine {
 public:
  Machine();
  ~Machine() { g_object_unref(bed_); }
  Machine(const Machine&) = delete;
  Machine& operator=(const Machine&) = delete;

  /// Each returns the device's syspath.
  std::string plug(const std::string& subsystem, const std::string& name, const Words& attributes,
                   const Words& properties = {});
  std::string plug_hwmon(const std::string& name, const std::string& value);
  /// A serial device; `other_end` is the pty that stands behind its name.
  std::string plug_tty(const std::string& name, int other_end, const Words& properties);
  void unplug(const std::string& path);
  void say(const std::string& path, const char* action);
  void set(const std::string& path, const std::string& attribute, const std::string& value);
  [[nodiscard]] std::string file(const std::string& path) const { return root_ + path; }

 private:
  UMockdevTestbed* bed_;
  std::string root_;
};

/// A terminal whose other end is a serial device's.
Descriptor make_pty();

/// The rules of config/sensors.
std::vector<SensorRule> shipped();

/// The devices' side as it runs in the sensor-bus.
struct Running {
  explicit Running(std::vector<SensorRule> rules = shipped());
  [[nodiscard]] bool until(const std::function<bool()>& holds, double timeout_s = 60) {
    return service.run_until(holds, timeout_s);
  }
  [[nodiscard]] bool tells(const std::string& key, double value);
  [[nodiscard]] bool fails(const std::string& key, const std::string& words);

  FakeService service;
  Heard heard;
  std::unique_ptr<Devices> devices;
};

/// Writes all of it, while the devices' side runs.
void say_line(const Descriptor& pty, Running& running, std::string_view bytes);

/// The properties of a serial thermometer that a shipped rule knows.
inline const Words kThermometer = {"ID_MODEL",    "My_Thermometer", "ID_VENDOR_ID",    "1209",
                                   "ID_MODEL_ID", "0001",           "ID_SERIAL_SHORT", "S1"};

}  // namespace trb::sensor::test
