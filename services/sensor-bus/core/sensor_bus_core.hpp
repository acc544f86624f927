// The sensor-bus: what is plugged in and what programs feed: sent to the fleet, requested, streamed. Values go over
// D-Bus: a request here is answered with the signal that any D-Bus program receives.
#pragma once

#include <map>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "common/actor/core.hpp"
#include "common/actor/takes.hpp"
#include "services/sensor-bus/core/effects.hpp"
#include "services/sensor-bus/core/sensors.hpp"
#include "services/sensor-bus/core/watches.hpp"

namespace trb::sensor {

class SensorBusCore : public Core {
 public:
  /// `node`: the own node's id.
  /// `robots`: the requests that the robot itself answers (robots_words).
  explicit SensorBusCore(std::string node, std::set<std::string> robots = {})
      : node_(std::move(node)), sensors_(std::move(robots)) {}

  using Taken = Takes<SensorRead, SensorWatch, SensorSnapshot, SensorListRequest>;

  void on_welcome(const NodeIdentity& node, Now now, Outbox& out) override;
  void on(const Inbound& message, Now now, Outbox& out) override;
  void tick(Now now, Outbox& out) override;
  [[nodiscard]] std::optional<MonotonicTime> next_deadline() const override;

  void on_plugged(const PluggedSensor& sensor, Now now, Outbox& out);
  void on_unplugged(const std::string& key, Now now, Outbox& out);
  void on_sample(const Sample& sample, Now now, Outbox& out);
  void on_picture(const Picture& picture, Now now, Outbox& out);
  void on_unknown(const std::vector<UnknownDevice>& devices) { unknown_ = devices; }
  void on_bus_events(const std::vector<BusEvent>& events, Now now, Outbox& out);

  /// What the steps since the last call want done, in order.
  std::vector<Effect> take_effects() { return std::exchange(effects_, {}); }

 private:
  /// Who waits for a sensor's next value, or its picture.
  struct Requester {
    Inbound asked;
    std::string name;
    Duration patience{};
    MonotonicTime deadline;
  };

  void on_request(const Inbound& asked, Now now, Outbox& out);
  static void refuse_unexpected(const Inbound& message, Outbox& out);
  static void refuse(const Inbound& asked, const Error& error, Outbox& out);
  void forget_node(const std::string& id);
  static bool make_room(std::vector<Requester>& waiting, const Inbound& asked, const Error& why, Outbox& out);
  void begin_read(const Inbound& asked, const SensorRead& body, Now now, Outbox& out);
  void begin_picture(const Inbound& asked, const SensorSnapshot& body, Now now, Outbox& out);
  void order_watch(const Inbound& asked, const SensorWatch& body, Now now, Outbox& out);
  void refuse_pictures(const std::string& name, const Error& error, Outbox& out);
  void send_picture(const SensorImage& image, Outbox& out);
  void send_table(const Inbound& asked, const SensorListRequest& body, Outbox& out) const;
  [[nodiscard]] Duration patience_of(const std::string& name, double timeout_s) const;

  void on_bus(const BusUp& up, Now now, Outbox& out);
  void on_bus(const BusDown& down, Now now, Outbox& out);
  void on_bus(const SignalHeard& heard, Now now, Outbox& out);
  void on_bus(const ProgramHeard& heard, Now now, Outbox& out);
  void on_bus(const SignalRefused& refused, Now now, Outbox& out);
  bool from_program(const std::string& name, Now now, Outbox& out);

  void deliver(const std::string& name, const SensorReading& reading, Now now, Outbox& out);
  [[nodiscard]] SensorReading reading_of(const std::string& name, const BusValue& value, Now now) const;
  void read_failed(const Sensor& sensor, const Error& error, Now now, Outbox& out);
  void send_last_value(const std::string& name, Now now, Outbox& out);
  void gone(const std::string& name, const std::string& why, Outbox& out);
  void expire(Now now, Outbox& out);
  void time_out(const Requester& requester, Outbox& out) const;

  void order(Effect effect);
  /// The end of every step: rules as they are needed, the fleet notified of what has changed.
  void settle(Now now, Outbox& out);
  void settle_rules();
  void announce(const Sensor& sensor);

  std::string node_;
  Sensors sensors_;
  Watches watches_;
  std::vector<Requester> reads_;
  std::vector<Requester> pictures_;
  std::vector<UnknownDevice> unknown_;
  std::vector<Effect> effects_;
  std::set<std::string> rules_;  ///< the names subscribed to
  bool bus_up_ = false;
  std::string bus_fault_ = "starting";  ///< also: its note
  bool welcomed_ = false;
  bool asked_changed_ = false;            ///< reads_ or watches_: rules_ may have to follow
  std::optional<MonotonicTime> tell_at_;  ///< the fleet
  std::optional<MonotonicTime> told_at_;
};

}  // namespace trb::sensor
