// What udev says: devices that are there, come, change and go.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "common/base/result.hpp"
#include "services/sensor-bus/core/device.hpp"

struct udev;
struct udev_device;
struct udev_monitor;

namespace trb::sensor {

class UdevMonitor {
 public:
  /// Which attributes of a subsystem's device are to be read.
  using Attributes = std::function<std::set<std::string>(const std::string& subsystem)>;

  /// Hears from now on. Errors: io_error.
  static Result<std::unique_ptr<UdevMonitor>> open(const std::set<std::string>& subsystems, Attributes attributes);
  UdevMonitor(const UdevMonitor&) = delete;
  UdevMonitor& operator=(const UdevMonitor&) = delete;
  ~UdevMonitor();

  struct Event {
    bool gone = false;        ///< only its syspath is told then
    std::string old_syspath;  ///< it has moved from there
    Device device;
  };
  [[nodiscard]] int fd() const;
  /// Which udevd there is that would send: another after each start of one. None: there is none, and whoever begins to
  /// listen then receives nothing, also later.
  struct Udevd {
    std::uint64_t file = 0;
    std::int64_t made_ns = 0;
    bool operator==(const Udevd&) const = default;
  };
  [[nodiscard]] static std::optional<Udevd> udevd();
  /// What has been said, in order. False: some was lost, so that enumerate() is needed.
  bool drain(const std::function<void(Event)>& on_event);
  /// Everything that is plugged in now.
  [[nodiscard]] std::vector<Device> enumerate() const;

 private:
  UdevMonitor(udev* library, std::set<std::string> subsystems, Attributes attributes);
  Device device_of(udev_device* device) const;

  udev* library_;
  udev_monitor* monitor_ = nullptr;
  std::set<std::string> subsystems_;
  Attributes attributes_;
};

}  // namespace trb::sensor
