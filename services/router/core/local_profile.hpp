// What the fleet gets to know of this node: the robot's profile, as its mode-adapter sent it, and the sensors that are
// plugged into this PC, as its sensor-bus sent them.
#pragma once

#include <optional>
#include <string_view>
#include <vector>

#include "services/router/core/link_errors.hpp"
#include "services/router/core/own_messages.hpp"
#include "services/router/core/peer_table.hpp"
#include "services/router/core/service_report.hpp"
#include "services/router/core/services.hpp"

namespace trb::router {

/// When the services that make the profile were last heard; nothing of one that is not connected, or has reported
/// nothing that could be given up.
struct ReportersHeard {
  std::optional<MonotonicTime> sensor_bus;
  std::optional<MonotonicTime> mode_adapter;
};

/// event                                                   | next
/// --------------------------------------------------------|------------------------------------------------------
/// sensors, from the sensor-bus                            | plugged; every peer gets what has changed
/// a robot's profile, from the mode-adapter                | every peer gets what has changed
/// a robot's profile that no peer would take (invalid)     | as before, also given up; counted, logged, a link error
/// the sensor-bus is gone, or silent (see ServiceReport)   | no sensors, until it reports or is heard again
/// the mode-adapter is gone, or silent                     | the robot is CONNECTION_BROKEN, and why, likewise
class LocalProfile {
 public:
  LocalProfile(const LocalNode& node, PeerTable& table, OwnMessages& messages, LinkErrors& errors)
      : node_(node), table_(table), messages_(messages), errors_(errors) {}

  void on_sensors(const NodeSensors& told, Effects& out);
  void on_robot(const NodeProfile& told, Now now, Effects& out);
  /// A service that is started again has three seconds to report again.
  void on_service_gone(std::string_view service, Now now);

  [[nodiscard]] const NodeProfile& profile() const { return whole_; }
  /// Increases with each change.
  [[nodiscard]] std::uint64_t number() const { return number_; }
  [[nodiscard]] bool is_plugged(std::string_view sensor) const;
  [[nodiscard]] bool has_plugged() const { return !plugged_.empty(); }
  [[nodiscard]] bool has_robot() const { return !robot_.robot.empty(); }
  /// Sends the profile by the link, if the other side has not got this version yet.
  void send(Link& link, Effects& out);

  void tick(const ReportersHeard& heard, Now now, Effects& out);
  [[nodiscard]] std::optional<MonotonicTime> next_deadline(const ReportersHeard& heard) const;

 private:
  void refuse(std::size_t size, Now now, Effects& out);
  bool make_fit(NodeProfile& profile) const;
  void log_change(const ServiceReport& report, const char* away, const char* back, const std::string& what,
                  Effects& out) const;
  [[nodiscard]] NodeProfile robot_as_known() const;
  void publish(Effects& out);

  const LocalNode& node_;
  PeerTable& table_;
  OwnMessages& messages_;
  LinkErrors& errors_;
  NodeProfile whole_;                ///< what the fleet gets
  NodeProfile robot_;                ///< of it, what the mode-adapter sent
  std::vector<SensorInfo> plugged_;  ///< of it, what the sensor-bus sent
  ServiceReport robot_report_;
  ServiceReport sensors_report_;
  std::uint64_t number_ = 1;
};

}  // namespace trb::router
