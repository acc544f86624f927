// What the fleet gets to know of this node: the robot's profile, as its mode-adapter sent it, and the sensors that are
// plugged into this PC, as its sensor-bus sent them.
#pragma once

#include <optional>
#include <string_view>
#include <vector>

#include "services/router/core/link_errors.hpp"
#include "services/router/core/own_messages.hpp"
#include "services/router/core/peer_table.hpp"

namespace trb::router {

constexpr std::string_view kSensorBus = "sensor-bus";

/// sensors | event                                                  | next
/// --------|--------------------------------------------------------|---------------------------------------------
/// any     | received from the sensor-bus                           | plugged; every peer gets what has changed
/// plugged | the sensor-bus's connection ends                       | lost: it has 3 s to come back
/// plugged | the sensor-bus is silent for a lease (expired)         | none; every peer gets that
/// lost    | received anew                                          | plugged
/// lost    | 3 s are over (expired)                                 | none; every peer gets that
/// any     | a robot's profile that no peer would take (invalid)    | as before; counted, logged, a link error
class LocalProfile {
 public:
  LocalProfile(const LocalNode& node, PeerTable& table, OwnMessages& messages, LinkErrors& errors)
      : node_(node), table_(table), messages_(messages), errors_(errors) {}

  void on_sensors(const NodeSensors& told, Effects& out);
  void on_robot(const NodeProfile& told, Now now, Effects& out);
  /// A sensor-bus that the supervisor restarts sends its sensors again within that time.
  void on_sensor_bus_gone(Now now);

  [[nodiscard]] const NodeProfile& profile() const { return whole_; }
  /// Increases with each change.
  [[nodiscard]] std::uint64_t number() const { return number_; }
  [[nodiscard]] bool is_plugged(std::string_view sensor) const;
  /// Sends the profile by the link, if the other side has not got this version yet.
  void send(Link& link, Effects& out);

  /// `last_heard`: of the sensor-bus, if it is connected.
  void tick(std::optional<MonotonicTime> last_heard, Now now, Effects& out);
  [[nodiscard]] std::optional<MonotonicTime> next_deadline(std::optional<MonotonicTime> last_heard) const;

 private:
  void refuse(std::size_t size, Now now, Effects& out);
  bool make_fit(NodeProfile& profile) const;
  void publish(Effects& out);

  const LocalNode& node_;
  PeerTable& table_;
  OwnMessages& messages_;
  LinkErrors& errors_;
  NodeProfile whole_;                  ///< what the fleet gets
  NodeProfile robot_;                  ///< of it, what the mode-adapter sent
  std::vector<SensorInfo> plugged_;    ///< of it, what the sensor-bus sent
  std::optional<MonotonicTime> lost_;  ///< until when a sensor-bus that is gone may come back
  std::uint64_t number_ = 1;
};

}  // namespace trb::router
