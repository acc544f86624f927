// The sensors that are plugged into this node's PC: told to the fleet beside what the robot has.
#include <algorithm>

#include "services/router/core/router_core.hpp"

namespace trb::router {
namespace {

constexpr std::string_view kSensorBus = "sensor-bus";
constexpr std::size_t kMaxNames = 255;        ///< NodeProfile::sensors
constexpr std::size_t kMaxCapabilities = 64;  ///< NodeProfile::capabilities

/// False if there is no room.
bool add_once(std::vector<std::string>& words, const std::string& word, std::size_t most) {
  if (word.empty() || std::find(words.begin(), words.end(), word) != words.end()) return true;
  if (words.size() >= most) return false;
  words.push_back(word);
  return true;
}

}  // namespace

bool RouterCore::is_plugged(std::string_view sensor) const {
  return std::any_of(plugged_.begin(), plugged_.end(), [&](const SensorInfo& info) { return info.name == sensor; });
}

void RouterCore::on_node_sensors(const NodeSensors& told, Effects& out) {
  sensors_lost_.reset();
  plugged_ = told.sensors;
  tell_own_profile(out);
}

void RouterCore::on_robot_profile(const NodeProfile& told, Now now, Effects& out) {
  NodeProfile profile = told;
  profile.plugged.clear();
  // That something is out of use must be known; the words of it can be read on the node.
  if (!fits(profile)) {
    for (OutOfUse& one : profile.out_of_use) one.text.clear();
  }
  if (!fits(profile)) return profile_refused(encode(profile).size(), now, out);
  robot_profile_ = std::move(profile);
  tell_own_profile(out);
}

/// No peer would take it: it is not told, and whoever looks sees why.
void RouterCore::profile_refused(std::size_t size, Now now, Effects& out) {
  const std::string text = "this node's own profile of " + std::to_string(size) + " bytes is not told, " +
                           std::to_string(kMaxProfileSize) + " are the most";
  out.count("refused.profile_too_large");
  out.log(LogLevel::error, "profile_too_large",
          text + "; the one before stands: name fewer skills, places or words in the robot's description");
  troubles_.note(config_.id, "", "profile_too_large", text, now.mono);
}

/// Every peer must be able to take it: what sensors say of themselves goes first, then the sensors, never the robot.
bool RouterCore::make_fit(NodeProfile& profile) const {
  if (fits(profile)) return true;
  for (SensorInfo& sensor : profile.plugged) sensor.detail.clear();
  if (fits(profile)) return false;
  for (SensorInfo& sensor : profile.plugged) sensor.device.clear();
  if (fits(profile)) return false;
  profile.plugged.clear();
  if (!fits(profile)) profile = robot_profile_;
  return false;
}

/// What the mode-adapter said and what the sensor-bus said, as one; told to every peer if it is another than before.
void RouterCore::tell_own_profile(Effects& out) {
  NodeProfile profile = robot_profile_;
  profile.plugged = plugged_;
  bool room = true;
  for (const SensorInfo& sensor : plugged_) {
    room = add_once(profile.sensors, sensor.name, kMaxNames) && room;
    room = add_once(profile.capabilities, sensor.kind, kMaxCapabilities) && room;
  }
  const bool whole = make_fit(profile);
  if (profile == profile_) return;
  if (!whole) {
    out.count("dropped.profile_details");
    out.log(LogLevel::warning, "profile_too_large",
            "with all that is plugged in the profile is over " + std::to_string(kMaxProfileSize) +
                " bytes: the fleet is not told all of its sensors (trb sensor list tells it here): plug in fewer");
  }
  if (!room) {
    out.log(LogLevel::warning, "too_many_sensors",
            "a profile has " + std::to_string(kMaxNames) + " sensors and " + std::to_string(kMaxCapabilities) +
                " capabilities at most: some are not among them");
  }
  profile_ = std::move(profile);
  ++profile_number_;
  for (const LinkId id : up_links()) tell_profile(links_.at(id), out);
}

/// The sensor-bus is gone: one that the supervisor starts again tells its sensors anew before they are missed.
void RouterCore::sensor_bus_gone(const Connection& connection, Now now) {
  if (connection.probe || connection.hello.service != kSensorBus || plugged_.empty()) return;
  sensors_lost_ = now.mono + config_.timing.service_silent;
}

/// When the sensors are given up: some seconds after their service's connection, or after a lease of its silence.
std::optional<MonotonicTime> RouterCore::sensors_end() const {
  if (plugged_.empty()) return std::nullopt;
  const auto holder = services_.holder(kSensorBus);
  const Connection* connection = holder ? services_.find(*holder) : nullptr;
  const auto silent =
      connection == nullptr ? std::nullopt : std::optional(connection->last_heard + config_.timing.lease);
  return earlier(sensors_lost_, silent);
}

void RouterCore::tick_sensors(Now now, Effects& out) {
  const auto end = sensors_end();
  if (!end || now.mono < *end) return;
  out.log(LogLevel::warning, "sensors_gone",
          std::to_string(plugged_.size()) + " sensors: their service has not told of them again");
  on_node_sensors({}, out);
}

}  // namespace trb::router
