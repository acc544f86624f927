#include "services/sensor-bus/core/sensors.hpp"

#include <algorithm>

#include "common/base/words.hpp"
#include "common/fleet/charge.hpp"
#include "common/fleet/sensor_unit.hpp"
#include "proto/body.hpp"
#include "proto/value.hpp"

namespace trb::sensor {
namespace {

constexpr std::size_t kMaxSensors = 255;  // SensorTable's and NodeSensors' bound
constexpr std::size_t kMaxFed = 64;
constexpr std::size_t kMaxRemembered = 1024;
constexpr std::size_t kMaxSerial = 120;
constexpr Duration kLeastPatience = std::chrono::seconds(1);
constexpr Duration kFedGone = std::chrono::seconds(60);

std::string_view device_of(std::string_view key) {
  return key.substr(0, key.rfind('#'));
}

}  // namespace

std::set<std::string> robots_words(std::set<std::string> requests) {
  requests.insert(std::begin(kChargeRequests), std::end(kChargeRequests));
  requests.emplace(kPositionRequest);
  return requests;
}

std::optional<Duration> Sensor::patience() const {
  if (period <= Duration::zero()) return std::nullopt;
  return std::max<Duration>(3 * period, kLeastPatience);
}

Result<const Sensor*> Sensors::plug(const PluggedSensor& plugged, MonotonicTime now) {
  if (by_key_.count(plugged.key) != 0)
    return fail(Errc::conflict, plugged.key + ": is plugged in already", "unplug it first");
  if (sensors_.size() >= kMaxSensors)
    return fail(Errc::queue_full, plugged.key + ": the node has 255 sensors already", "unplug some");
  Sensor sensor;
  sensor.info = plugged.info;
  sensor.info.name = name_for(plugged);
  sensor.info.state = SensorState::unread;
  sensor.key = plugged.key;
  sensor.serial = cut_utf8(plugged.info.identity, kMaxSerial);
  sensor.why = plugged.info.detail;
  if (plugged.every_s > 0) sensor.period = seconds(std::clamp(plugged.every_s, 0.001, 86'400.0));
  Sensor& added = add(std::move(sensor), now);
  by_key_[added.key] = added.info.name;
  settle_identities(added.serial);
  return &added;
}

Sensor& Sensors::add(Sensor sensor, MonotonicTime now) {
  sensor.number = ++count_;
  sensor.since = now;
  change_.list = true;
  const std::string name = sensor.info.name;
  Sensor& added = sensors_[name] = std::move(sensor);
  look_at(added);
  return added;
}

/// The one it had before, if that is free; else as its rule wishes, with a number if that is taken.
std::string Sensors::name_for(const PluggedSensor& plugged) {
  const std::string wish = to_sensor_name(plugged.info.name);
  const std::string id =
      plugged.info.identity.empty() ? "at " + plugged.key : "id " + plugged.info.identity + " " + wish;
  const auto known = remembered_.find(id);
  if (known != remembered_.end() && sensors_.count(known->second) == 0) return known->second;
  std::string name = free_name(wish);
  if (remembered_.size() >= kMaxRemembered) remembered_.erase(remembered_.begin());
  remembered_.emplace(id, name);  // of two with one serial number the first one's stays
  return name;
}

std::string Sensors::free_name(const std::string& wish) const {
  std::string name = wish;
  for (int i = 2; sensors_.count(name) != 0 || is_taken_word(name); ++i) name = wish + "_" + std::to_string(i);
  return name;
}

/// A word of the middleware's own would never reach the sensor as a request; one of the robot's is the robot's.
bool Sensors::is_taken_word(const std::string& name) const {
  return is_reserved(name) || robots_.contains(name);
}

std::optional<std::string> Sensors::unplug(const std::string& key) {
  const auto at = by_key_.find(key);
  if (at == by_key_.end()) return std::nullopt;
  std::string name = std::move(at->second);
  by_key_.erase(at);
  const std::string serial = sensors_.at(name).serial;
  sensors_.erase(name);
  change_.list = true;
  settle_identities(serial);
  return name;
}

/// The sensors of one device have one identity; of two devices with one serial number the later one's is made distinct.
void Sensors::settle_identities(const std::string& serial) {
  if (serial.empty()) return;
  std::vector<Sensor*> same;
  for (auto& [name, sensor] : sensors_) {
    if (!sensor.fed() && sensor.serial == serial) same.push_back(&sensor);
  }
  std::ranges::sort(same, {}, [](const Sensor* sensor) { return sensor->number; });
  std::vector<std::string_view> devices;
  for (Sensor* sensor : same) {
    const std::string_view device = device_of(sensor->key);
    auto at = std::ranges::find(devices, device);
    if (at == devices.end()) at = devices.insert(devices.end(), device);
    const auto nth = at - devices.begin() + 1;
    const std::string identity = nth == 1 ? serial : serial + "#" + std::to_string(nth);
    if (sensor->info.identity != identity) change_.list = true;
    sensor->info.identity = identity;
    sensor->twin = nth == 1 ? "" : "another device has the serial number " + serial + ", too";
    refresh_detail(*sensor);
  }
}

Result<const Sensor*> Sensors::add_fed(const std::string& name, MonotonicTime now) {
  if (is_taken_word(name)) {
    return fail(Errc::not_permitted,
                "a program feeds trbots." + name + ", a word of the " +
                    (is_reserved(name) ? "middleware's" : "robot's") + " own",
                "give it another name");
  }
  const auto fed = std::ranges::count_if(sensors_, [](const auto& one) { return one.second.fed(); });
  if (static_cast<std::size_t>(fed) >= kMaxFed || sensors_.size() >= kMaxSensors)
    return fail(Errc::queue_full, "trbots." + name + ": programs feed too many sensors", "64 at most");
  Sensor sensor;
  sensor.info = {name, name, "", "", "a program on D-Bus", SensorState::ok, std::string(kUnitNotRead)};
  sensor.why = kUnitNotRead;
  sensor.heard = now;
  return &add(std::move(sensor), now);
}

Result<const Sensor*> Sensors::fed(const std::string& name, MonotonicTime now) {
  const auto at = sensors_.find(name);
  if (at == sensors_.end()) return add_fed(name, now);
  Sensor& sensor = at->second;
  if (!sensor.fed())
    return fail(Errc::not_permitted, "a program emits trbots." + name + ", which is the name of a device",
                "give it another name");
  // Each signal may come twice, by the rule that discovers and by the one that reads.
  constexpr Duration kOneSignal = std::chrono::milliseconds(5);
  if (const Duration gap = now - *sensor.heard; gap > kOneSignal) {
    sensor.period = std::max<Duration>(gap, (7 * sensor.period + 3 * gap) / 10);
    sensor.heard = now;
  }
  set_state(sensor, SensorState::ok, sensor.value ? "" : std::string(kUnitNotRead));
  look_at(sensor);
  return &sensor;
}

void Sensors::set_value(const std::string& name, const BusValue& value, MonotonicTime measured, MonotonicTime now) {
  const auto at = sensors_.find(name);
  if (at == sensors_.end()) return;
  Sensor& sensor = at->second;
  if (!sensor.fed()) sensor.heard = now;
  sensor.value = value;
  sensor.measured = measured;
  if (!value.unit.empty() && value.unit != sensor.info.unit) {
    sensor.info.unit = value.unit;
    change_.list = true;
  }
  set_state(sensor, SensorState::ok, "");
  look_at(sensor);
}

void Sensors::failed(const std::string& name, const std::string& why, SensorState state) {
  if (const auto at = sensors_.find(name); at != sensors_.end()) set_state(at->second, state, why);
}

void Sensors::set_state(Sensor& sensor, SensorState state, const std::string& why) {
  if (sensor.info.state == state && sensor.why == why) return;
  sensor.info.state = state;
  sensor.why = why;
  change_.state = true;
  refresh_detail(sensor);
}

void Sensors::refresh_detail(Sensor& sensor) {
  const std::string detail = sensor.why + (sensor.why.empty() || sensor.twin.empty() ? "" : "; ") + sensor.twin;
  if (detail == sensor.info.detail) return;
  sensor.info.detail = cut_utf8(detail, 255);
  change_.state = true;
}

/// When something follows from its silence.
std::optional<MonotonicTime> Sensors::deadline(const Sensor& sensor) const {
  const MonotonicTime last = sensor.heard.value_or(sensor.since);
  const bool waits = sensor.info.state == SensorState::ok || sensor.info.state == SensorState::unread;
  std::optional<MonotonicTime> out;
  if (const auto patience = sensor.patience(); patience && waits) out = last + *patience;
  if (sensor.fed()) out = earlier(out, last + kFedGone);
  return out;
}

void Sensors::look_at(const Sensor& sensor) {
  next_check_ = earlier(next_check_, deadline(sensor));
}

Sensors::Late Sensors::check(MonotonicTime now) {
  Late late;
  if (!next_check_ || now < *next_check_) return late;
  next_check_.reset();
  for (auto at = sensors_.begin(); at != sensors_.end();) {
    Sensor& sensor = at->second;
    const MonotonicTime last = sensor.heard.value_or(sensor.since);
    if (sensor.fed() && now - last >= kFedGone) {
      late.gone.push_back(at->first);
      at = sensors_.erase(at);
      change_.list = true;
      continue;
    }
    if (const auto due = deadline(sensor); due && *due <= now) {
      set_state(sensor, SensorState::silent, "no value for three of its periods");
      late.silent.push_back(at->first);
    }
    look_at(sensor);
    ++at;
  }
  return late;
}

const Sensor* Sensors::find(const std::string& name) const {
  const auto at = sensors_.find(name);
  return at == sensors_.end() ? nullptr : &at->second;
}

const Sensor* Sensors::find_key(const std::string& key) const {
  const auto at = by_key_.find(key);
  return at == by_key_.end() ? nullptr : find(at->second);
}

Result<std::string> Sensors::resolve(const std::string& sensor, const std::string& identity) const {
  std::vector<std::string> found;
  for (const auto& [name, one] : sensors_) {
    const bool meant = identity.empty() ? one.info.kind == sensor : one.info.identity == identity;
    if (meant) found.push_back(name);
  }
  if (!identity.empty() && found.empty())
    return fail(Errc::unknown_target, "no sensor here has the identity " + identity, "there are: " + names());
  if (std::ranges::find(found, sensor) != found.end()) return sensor;
  if (identity.empty() && sensors_.count(sensor) != 0) return sensor;
  if (!identity.empty() && found.size() > 1) {
    // One device with several sensors.
    std::erase_if(found, [&](const std::string& name) { return sensors_.at(name).info.kind != sensor; });
    if (found.size() != 1) {
      return fail(Errc::bad_value, "several sensors have the identity " + identity, "name one, too: " + names());
    }
  }
  if (found.size() == 1) return found.front();
  if (found.size() > 1)
    return fail(Errc::bad_value, "several sensors are of kind " + sensor, "name one: " + joined(found));
  if (is_sensor_name(sensor) && !is_taken_word(sensor)) return sensor;
  return fail(Errc::unknown_target, "'" + cut_utf8(sensor, 64) + "' is no sensor", "there are: " + names());
}

std::vector<SensorInfo> Sensors::infos() const {
  std::vector<SensorInfo> out;
  for (const auto& [name, sensor] : sensors_) out.push_back(sensor.info);
  return out;
}

std::string Sensors::names() const {
  constexpr std::size_t kShown = 20;
  std::vector<std::string> shown;
  for (const auto& [name, sensor] : sensors_) {
    if (shown.size() < kShown) shown.push_back(name);
  }
  if (shown.empty()) return "none";
  if (sensors_.size() > kShown) shown.push_back("and " + std::to_string(sensors_.size() - kShown) + " more");
  return joined(shown);
}

}  // namespace trb::sensor
