// The sensors of the node: names made unique, identity, state. What is plugged in and what programs feed.
#pragma once

#include <map>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "services/sensor-bus/core/bus_value.hpp"
#include "services/sensor-bus/core/device_events.hpp"

namespace trb::sensor {

/// The words of a node's robot, which no sensor takes: `requests`, those of commands.json, and what the fleet asks
/// every robot for, its position and charge. A robot with a field channel answers these without an entry in
/// commands.json.
std::set<std::string> robots_words(std::set<std::string> requests);

struct Sensor {
  SensorInfo info;
  std::string key;           ///< its device's; empty: a program feeds it
  std::string serial;        ///< its device's own; info.identity is made distinct
  Duration period{};         ///< zero: not known (yet)
  std::uint64_t number = 0;  ///< rises with each sensor that came
  MonotonicTime since;
  std::optional<MonotonicTime> heard;     ///< when it last sent a value
  std::optional<BusValue> value;          ///< the last one
  std::optional<MonotonicTime> measured;  ///< the moment of value.time
  std::string why;                        ///< part of info.detail: of its state
  std::string twin;                       ///< part of info.detail: of its identity

  [[nodiscard]] bool fed() const { return key.empty(); }
  /// Three of its periods, 1 s at least; of an unknown period none.
  [[nodiscard]] std::optional<Duration> patience() const;
};

class Sensors {
 public:
  /// `robots`: what the robot itself answers (robots_words): no sensor takes such a request from it.
  explicit Sensors(std::set<std::string> robots = {}) : robots_(std::move(robots)) {}

  /// Errors: queue_full; conflict (the key is there already).
  Result<const Sensor*> plug(const PluggedSensor& plugged, MonotonicTime now);
  /// The name that has become free, if the key was known.
  std::optional<std::string> unplug(const std::string& key);

  /// A program has sent a value of that name. Errors: not_permitted (a device's, or a word of the middleware's or the
  /// robot's), queue_full.
  Result<const Sensor*> fed(const std::string& name, MonotonicTime now);

  void set_value(const std::string& name, const BusValue& value, MonotonicTime measured, MonotonicTime now);
  void failed(const std::string& name, const std::string& why, SensorState state = SensorState::failed);

  /// What has fallen silent; and the fed ones that are gone after a minute of it.
  struct Late {
    std::vector<std::string> silent;
    std::vector<std::string> gone;
  };
  Late check(MonotonicTime now);
  [[nodiscard]] std::optional<MonotonicTime> next_check() const { return next_check_; }

  [[nodiscard]] const Sensor* find(const std::string& name) const;
  [[nodiscard]] const Sensor* find_key(const std::string& key) const;
  /// By identity, else by name, else by kind. A name that is no sensor's (yet) is returned as it is. Errors:
  /// unknown_target, bad_value (several); both say what there is.
  [[nodiscard]] Result<std::string> resolve(const std::string& sensor, const std::string& identity) const;
  /// In order of their names.
  [[nodiscard]] std::vector<SensorInfo> infos() const;
  [[nodiscard]] std::string names() const;
  [[nodiscard]] const std::map<std::string, Sensor>& all() const { return sensors_; }

  /// True if what the fleet gets has changed since the last call.
  struct Change {
    bool list = false;   ///< a sensor came, left or is called otherwise
    bool state = false;  ///< of one of them
  };
  Change take_change() { return std::exchange(change_, {}); }

 private:
  Result<const Sensor*> add_fed(const std::string& name, MonotonicTime now);
  Sensor& add(Sensor sensor, MonotonicTime now);
  std::string free_name(const std::string& wish) const;
  [[nodiscard]] bool is_taken_word(const std::string& name) const;
  std::string name_for(const PluggedSensor& plugged);
  void settle_identities(const std::string& serial);
  void set_state(Sensor& sensor, SensorState state, const std::string& why);
  void refresh_detail(Sensor& sensor);
  void look_at(const Sensor& sensor);
  [[nodiscard]] std::optional<MonotonicTime> deadline(const Sensor& sensor) const;

  std::set<std::string> robots_;
  std::map<std::string, Sensor> sensors_;
  std::map<std::string, std::string> by_key_;
  std::map<std::string, std::string> remembered_;  ///< which name a device had
  std::optional<MonotonicTime> next_check_;
  std::uint64_t count_ = 0;
  Change change_;
};

}  // namespace trb::sensor
