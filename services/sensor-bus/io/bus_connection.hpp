// One life of the connection to the D-Bus, from its making until it breaks. Every call may block for a second and may
// throw (sdbus::Error): then the connection is of no use any more.
#pragma once

#include <sdbus-c++/sdbus-c++.h>

#include <functional>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "common/base/time.hpp"
#include "services/sensor-bus/core/effects.hpp"

namespace trb::sensor {

class BusConnection {
 public:
  using Tell = std::function<void(BusEvent)>;

  /// `where`: "system", "session" or an address. Owns the name trbots.sensors from now on, and receives what other
  /// programs feed.
  BusConnection(const std::string& where, Tell tell);
  BusConnection(const BusConnection&) = delete;
  BusConnection& operator=(const BusConnection&) = delete;

  /// What is not as it should be, though the bus can be used.
  [[nodiscard]] const std::string& note() const { return note_; }

  void carry_out(const Effect& effect);
  /// Handles what has come; false if there may be more.
  bool process();
  /// Asks the bus whether it lives.
  void ping();

  struct Wait {
    int fd = -1;
    short events = 0;
    int timeout_ms = -1;
  };
  [[nodiscard]] std::vector<Wait> waits() const;

 private:
  void own_name();
  void announce(const Announce& order);
  void subscribe(const std::string& name);
  void emit(const EmitValue& order);
  void on_subscribed(const std::string& name, sdbus::Message& message);
  void on_discovered(const sdbus::Message& message);

  Tell tell_;
  std::string note_;
  std::unique_ptr<sdbus::IConnection> work_;   ///< emits, and receives what is subscribed to
  std::unique_ptr<sdbus::IConnection> watch_;  ///< notices who feeds: one rule for ever, headers only
  std::string own_;                            ///< the unique name of work_
  std::unique_ptr<sdbus::IProxy> bus_;
  std::map<std::string, std::unique_ptr<sdbus::IObject>> objects_;
  std::map<std::string, sdbus::Slot> rules_;
  std::map<std::string, MonotonicTime> told_;  ///< when a program was told of last, by sensor
};

}  // namespace trb::sensor
