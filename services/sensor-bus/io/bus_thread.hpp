// The D-Bus on a thread of its own: making a connection, a name and a rule all wait for the bus, and one that hangs
// must hold up nobody who asks for what is no sensor's. The loop and the thread share two queues.
#pragma once

#include <functional>
#include <memory>
#include <string>
#include <thread>
#include <vector>

#include "common/service/service.hpp"
#include "services/sensor-bus/core/effects.hpp"

namespace trb::sensor {

class BusThread {
 public:
  /// `where`: "system", "session" or an address. `tell` is called in the service's loop. Errors: io_error.
  static Result<std::unique_ptr<BusThread>> open(std::string where, Service& service,
                                                 std::function<void(const std::vector<BusEvent>&)> tell);
  BusThread(const BusThread&) = delete;
  BusThread& operator=(const BusThread&) = delete;
  /// Leaves a thread that hangs in the bus behind after a second.
  ~BusThread();

  void carry_out(std::vector<Effect> effects);

 private:
  struct Shared;
  BusThread(std::shared_ptr<Shared> shared, Service& service, std::function<void(const std::vector<BusEvent>&)> tell);
  static void run(const std::string& where, Shared& shared);
  static void live(const std::string& where, Shared& shared, Duration& wait);
  void on_bus_events();

  std::shared_ptr<Shared> shared_;
  Service& service_;
  std::function<void(const std::vector<BusEvent>&)> tell_;
  std::thread thread_;
};

}  // namespace trb::sensor
