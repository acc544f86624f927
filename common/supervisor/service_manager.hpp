#pragma once

#include <optional>
#include <string>

#include "common/base/time.hpp"

namespace trb::supervisor {

/// systemd, if it has started this process with Type=notify (sd_notify(3)); else nobody, and nothing is said. What it
/// set for this process alone is taken out of the environment, so that no child speaks in its name.
class ServiceManager {
 public:
  /// Reads and takes WATCHDOG_USEC.
  ServiceManager();

  void ready() const;
  /// What `systemctl status` shows from now on; empty: nothing. The same again is not said again.
  void waits(const std::string& text);
  void stopping() const;
  /// Says that this process is alive, if that is due: twice in the time within which it is expected.
  void keep_alive(MonotonicTime now);
  /// When keep_alive() is due; nothing: it never is.
  [[nodiscard]] std::optional<MonotonicTime> next() const { return next_; }

  /// In a child, before it becomes another program.
  static void forget();

 private:
  Duration period_{};  ///< zero: nobody waits
  std::string waits_;  ///< what was said last
  std::optional<MonotonicTime> next_;
};

}  // namespace trb::supervisor
