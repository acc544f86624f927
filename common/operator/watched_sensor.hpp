#pragma once

#include <functional>
#include <memory>
#include <string>

#include "common/base/back_off.hpp"
#include "common/operator/find_sensor.hpp"
#include "common/operator/session.hpp"

namespace trb::op {

/// A sensor's values as they arrive. The watch is renewed every 3 s at its node; if that node reports that the sensor
/// is gone, or is not reached, the sensor is looked up every 0.5 s; one with a serial number is found wherever it is
/// plugged in next. If its node has no room for it, or another one's watch took its place, it waits longer each time, 8
/// s at most: else two of them would take each other's place for ever.
class WatchedSensor {
 public:
  struct Events {
    std::function<void(const std::string& node, const SensorReading&)> value;
    std::function<void(const std::string& text)> note;  ///< it was lost, or found elsewhere
  };
  /// `every_s`: the shortest time between values.
  WatchedSensor(Session& session, SensorWish wish, double every_s, Events events);
  WatchedSensor(const WatchedSensor&) = delete;
  WatchedSensor& operator=(const WatchedSensor&) = delete;

  /// Looks the sensor up and asks its node for values. Errors: those of find_sensor and Session::request; bad_value (it
  /// sends pictures).
  void begin(const Callback<Done>& begun);
  /// To be called with every message that answers no request.
  void receive(const Message& message);
  /// Ends the stream of values; the object may then be destroyed.
  void end();

 private:
  void order_first(const FoundSensor& found, const Callback<Done>& begun);
  /// A lost one is sent again with the next renewal.
  void order(double lease_s);
  [[nodiscard]] Send order_of(double lease_s) const;
  void renew_in(Duration wait);
  void renew();
  void look();
  void lose(const Nack& why);
  /// Calls the given function, unless the watch has ended by then.
  template <class Call>
  auto while_alive(Call call);

  Session& session_;
  SensorWish wish_;
  double every_s_;
  Events events_;
  std::uint64_t number_ = 0;  ///< of this watch; its values carry it
  FoundSensor sensor_;
  bool here_ = false;  ///< the sensor's node was asked for values
  BackOff for_room_{std::chrono::milliseconds(500), std::chrono::seconds(8)};
  std::uint64_t renewals_ = 0;                            ///< only the newest timer counts
  std::shared_ptr<int> alive_ = std::make_shared<int>();  ///< destroyed with the watch: a weak pointer to it shows
                                                          ///< whether it still exists
};

}  // namespace trb::op
