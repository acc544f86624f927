#include "common/supervisor/service_manager.hpp"

#include <systemd/sd-daemon.h>

#include <cstdint>
#include <cstdlib>

namespace trb::supervisor {

ServiceManager::ServiceManager() {
  std::uint64_t usec = 0;
  if (::sd_watchdog_enabled(1, &usec) <= 0) return;
  period_ = std::chrono::microseconds(usec) / 2;
  next_.emplace();
}

void ServiceManager::ready() const {
  ::sd_notify(0, "READY=1");
}

void ServiceManager::waits(const std::string& text) {
  if (text == waits_) return;
  waits_ = text;
  ::sd_notify(0, ("STATUS=" + (text.empty() ? "" : "waits: " + text)).c_str());
}

void ServiceManager::stopping() const {
  ::sd_notify(0, "STOPPING=1");
}

void ServiceManager::keep_alive(MonotonicTime now) {
  if (!next_ || now < *next_) return;
  ::sd_notify(0, "WATCHDOG=1");
  next_ = now + period_;
}

void ServiceManager::forget() {
  ::unsetenv("NOTIFY_SOCKET");
}

}  // namespace trb::supervisor
