// Which devices are sensors: the rules applied to what is plugged in, and what changes when a device comes or goes.
#pragma once

#include <map>
#include <memory>
#include <set>
#include <string>
#include <vector>

#include "common/fleet/sensor_rule.hpp"
#include "services/sensor-bus/core/device.hpp"
#include "services/sensor-bus/core/device_events.hpp"

namespace trb::sensor {

/// One sensor of a device, and what its reader needs of it.
struct FoundChannel {
  PluggedSensor plugged;
  const SensorChannel* how = nullptr;  ///< of the rule
  std::string attribute;               ///< the file that is meant; for a raw channel "in_temp"
  bool is_raw = false;                 ///< (raw + offset) * scale of that channel's files
};

/// A device that a rule knows.
struct FoundDevice {
  Device device;
  std::shared_ptr<const SensorRule> rule;
  std::vector<FoundChannel> channels;
};

/// The rule applied; no channels: none of its sensors is at the device.
FoundDevice find_sensors(const Device& device, const std::shared_ptr<const SensorRule>& rule);

bool matches(const DeviceMatch& match, const Device& device);

/// Everything that is plugged in. Bounded: of more than kMaxDevices the later ones are not looked at, and counted.
class Recognition {
 public:
  static constexpr std::size_t kMaxDevices = 1024;

  explicit Recognition(std::vector<SensorRule> rules);

  /// What a device's coming or going means. Both may be empty: a repeated or a foreign event.
  struct Change {
    std::vector<std::string> unplugged;  ///< syspaths
    std::vector<FoundDevice> plugged;
    bool unknown_changed = false;
  };
  /// It is there: added, changed, bound again; called any number of times.
  Change on_present(Device device);
  Change on_gone(const std::string& syspath);
  /// It has got another path, as when a parent is renamed.
  Change on_moved(const std::string& old_syspath, Device device);

  /// Those that no rule knows and that may be sensors, without those below a known one; 64 at most.
  [[nodiscard]] std::vector<UnknownDevice> unknown() const;

  /// What is looked at at all: what sensors are usually in, and what the rules name.
  [[nodiscard]] const std::set<std::string>& subsystems() const { return subsystems_; }
  /// The attributes of devices of that subsystem that must be read to recognise one.
  [[nodiscard]] std::set<std::string> attributes_of(const std::string& subsystem) const;
  /// The syspaths of everything that is plugged in.
  [[nodiscard]] std::vector<std::string> present() const;
  [[nodiscard]] std::uint64_t refused() const { return refused_; }

 private:
  struct Known {
    Device device;
    std::string looks;  ///< its sensors in one text: another one means another device
  };
  [[nodiscard]] FoundDevice recognise(const Device& device) const;
  Change put_unknown(Device device);

  std::vector<std::shared_ptr<const SensorRule>> rules_;
  std::set<std::string> subsystems_;
  std::map<std::string, Known> known_;  ///< by syspath
  std::map<std::string, Device> unknown_;
  std::uint64_t refused_ = 0;
};

}  // namespace trb::sensor
