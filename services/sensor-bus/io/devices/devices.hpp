// The devices of this machine: recognised as they are plugged in, read by a thread each, told to the core.
#pragma once

#include <map>
#include <memory>
#include <string>
#include <vector>

#include "common/log/log.hpp"
#include "common/service/service.hpp"
#include "services/sensor-bus/core/recognition.hpp"
#include "services/sensor-bus/io/devices/reader_thread.hpp"
#include "services/sensor-bus/io/devices/udev_monitor.hpp"

namespace trb::sensor {

class Devices final : public DeviceControl {
 public:
  /// Hears from now on; what is plugged in already is told once the service runs. `service` and `listener` must outlive
  /// it. Errors: io_error.
  static Result<std::unique_ptr<Devices>> open(Service& service, DeviceListener& listener,
                                               std::vector<SensorRule> rules);
  Devices(const Devices&) = delete;
  Devices& operator=(const Devices&) = delete;
  /// Waits a short while for its threads; one that hangs is left behind.
  ~Devices() override;

  void read_now(const std::string& key) override;
  void take_picture(const std::string& key) override;

  /// For tests and the log.
  struct Counts {
    std::size_t devices = 0;      ///< that a rule knows
    std::size_t threads = 0;      ///< with those that were left behind
    std::size_t left_behind = 0;  ///< threads that hang in a device that is gone
  };
  [[nodiscard]] Counts counts() const;

 private:
  struct Plugged {
    FoundDevice found;
    std::shared_ptr<ReaderOrders> reader;  ///< none: it could not be started
    std::int64_t hangs_since = 0;          ///< the call that it was told of as hanging; 0: none
    bool picture_asked = false;
  };
  using Place = std::pair<Plugged*, std::size_t>;

  Devices(Service& service, DeviceListener& listener, std::vector<SensorRule> rules, std::shared_ptr<ReaderPool> pool);
  Status open_monitor();
  void look_for_udevd(MonotonicTime now);
  void scan();
  void on_udev();
  void on_event(UdevMonitor::Event event);
  void apply(Recognition::Change change);
  void notify_unknown();
  void plug(FoundDevice found);
  void unplug(const std::string& syspath);
  void on_posts();
  void on_post(Post post);
  void look(Now now);
  void look_at(Plugged& plugged, MonotonicTime now);
  void fail_all(const Plugged& plugged, const Error& error);
  [[nodiscard]] std::optional<Place> place(const std::string& key);

  Service& service_;
  DeviceListener& listener_;
  Recognition recognition_;
  std::shared_ptr<ReaderPool> reader_pool_;
  std::unique_ptr<UdevMonitor> monitor_;
  std::map<std::string, Plugged> plugged_;              ///< by syspath
  std::map<std::uint64_t, std::string> reader_of_;      ///< reader's number: syspath
  std::vector<std::shared_ptr<ReaderOrders>> leaving_;  ///< told to end, not gone yet
  MonotonicTime next_look_;                             ///< at once: what is plugged in already
  MonotonicTime next_udevd_look_;
  std::optional<UdevMonitor::Udevd> udevd_;  ///< that is listened to
  std::uint64_t readers_ = 0;
  std::uint64_t dropped_ = 0;
  bool scanned_ = false;
  bool unknown_changed_ = false;  ///< told once for all that came together
  RateLimit limit_;
};

}  // namespace trb::sensor
