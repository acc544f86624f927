#include "services/router/core/local_profile.hpp"

#include <algorithm>

namespace trb::router {
namespace {

constexpr std::size_t kMaxNames = 255;        ///< NodeProfile::sensors
constexpr std::size_t kMaxCapabilities = 64;  ///< NodeProfile::capabilities

/// False if there is no room.
bool add_once(std::vector<std::string>& words, const std::string& word, std::size_t most) {
  if (word.empty() || std::find(words.begin(), words.end(), word) != words.end()) return true;
  if (words.size() >= most) return false;
  words.push_back(word);
  return true;
}

/// What it was told last, once nobody tells how the robot is; what it can do stays.
NodeProfile unreported(NodeProfile profile) {
  profile.robot = "CONNECTION_BROKEN";
  profile.detail = "its mode-adapter does not report: trb service list on its node";
  return profile;
}

bool fits_always(const NodeProfile& profile) {
  return fits(profile) && fits(unreported(profile));
}

}  // namespace

bool LocalProfile::is_plugged(std::string_view sensor) const {
  return sensors_report_.is_valid() &&
         std::any_of(plugged_.begin(), plugged_.end(), [&](const SensorInfo& info) { return info.name == sensor; });
}

void LocalProfile::on_sensors(const NodeSensors& told, Effects& out) {
  sensors_report_.on_report();
  plugged_ = told.sensors;
  publish(out);
}

void LocalProfile::on_robot(const NodeProfile& told, Now now, Effects& out) {
  NodeProfile profile = told;
  profile.plugged.clear();
  // The fleet must know that something is out of use; the details can be read on the node.
  if (!fits_always(profile)) {
    for (OutOfUse& one : profile.out_of_use) one.text.clear();
  }
  if (!fits_always(profile)) return refuse(encode(profile).size(), now, out);
  robot_ = std::move(profile);
  robot_report_ = {};
  if (!robot_.robot.empty()) robot_report_.on_report();
  publish(out);
}

/// No peer would take it: it is not sent, and the log and `trb doctor` show why.
void LocalProfile::refuse(std::size_t size, Now now, Effects& out) {
  const std::string text = "this node's own profile of " + std::to_string(size) + " bytes is not told, " +
                           std::to_string(kMaxProfileSize) + " are the most";
  out.count("refused.profile_too_large");
  out.log(LogLevel::error, "profile_too_large",
          text + "; the one before stands: name fewer skills, places or words in the robot's description");
  errors_.note(node_.id(), "", "profile_too_large", text, now);
}

/// Every peer must be able to take it: the sensors' details are left out first, then the sensors, never the robot.
bool LocalProfile::make_fit(NodeProfile& profile) const {
  if (fits(profile)) return true;
  for (SensorInfo& sensor : profile.plugged) sensor.detail.clear();
  if (fits(profile)) return false;
  for (SensorInfo& sensor : profile.plugged) sensor.device.clear();
  if (fits(profile)) return false;
  profile.plugged.clear();
  if (!fits(profile)) profile = robot_as_known();
  return false;
}

NodeProfile LocalProfile::robot_as_known() const {
  return robot_.robot.empty() || robot_report_.is_valid() ? robot_ : unreported(robot_);
}

/// Merges the mode-adapter's and the sensor-bus's parts; every peer gets the profile if it has changed.
void LocalProfile::publish(Effects& out) {
  NodeProfile profile = robot_as_known();
  if (sensors_report_.is_valid()) profile.plugged = plugged_;
  bool room = true;
  for (const SensorInfo& sensor : profile.plugged) {
    room = add_once(profile.sensors, sensor.name, kMaxNames) && room;
    room = add_once(profile.capabilities, sensor.kind, kMaxCapabilities) && room;
  }
  const bool whole = make_fit(profile);
  if (profile == whole_) return;
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
  whole_ = std::move(profile);
  ++number_;
  for (const LinkId id : table_.up_links()) send(*table_.link(id), out);
}

void LocalProfile::send(Link& link, Effects& out) {
  if (link.profile == number_) return;
  link.profile = number_;
  messages_.send(link, whole_, out);
}

void LocalProfile::on_service_gone(std::string_view service, Now now) {
  const MonotonicTime end = now.mono + node_.config().timing.service_silent;
  if (service == kSensorBus) sensors_report_.on_gone(end);
  if (service == kModeAdapter) robot_report_.on_gone(end);
}

std::optional<MonotonicTime> LocalProfile::next_deadline(const ReportersHeard& heard) const {
  const Duration lease = node_.config().timing.lease;
  return earlier(sensors_report_.next_deadline(heard.sensor_bus, lease),
                 robot_report_.next_deadline(heard.mode_adapter, lease));
}

void LocalProfile::tick(const ReportersHeard& heard, Now now, Effects& out) {
  const Duration lease = node_.config().timing.lease;
  const bool sensors = sensors_report_.tick(heard.sensor_bus, lease, now.mono);
  const bool robot = robot_report_.tick(heard.mode_adapter, lease, now.mono);
  if (sensors && !plugged_.empty())
    log_change(sensors_report_, "sensors_gone", "sensors_back", std::to_string(plugged_.size()) + " sensors", out);
  if (robot) log_change(robot_report_, "robot_unreported", "robot_reported", "the robot", out);
  if (sensors || robot) publish(out);
}

void LocalProfile::log_change(const ServiceReport& report, const char* away, const char* back, const std::string& what,
                              Effects& out) const {
  if (report.is_valid()) return out.log(LogLevel::info, back, what + ": the service that reports them is heard again");
  out.log(LogLevel::warning, away, what + ": the service that reports them does not report");
}

}  // namespace trb::router
