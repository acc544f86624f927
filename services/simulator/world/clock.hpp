// A computer's clocks: the world's time, and a UTC that may be wrong.
#pragma once

#include "common/simulation/fault.hpp"
#include "services/simulator/world/events.hpp"

namespace trb::world {

using simulation::ClockFault;

class Clock {
 public:
  explicit Clock(const Events& events) : events_(events), since_(events.now()) {}

  void set(const ClockFault& fault) {
    since_ = events_.now();
    ahead_ = fault.is_1970 ? Duration{-kUtc - since_.ns} : seconds(fault.ahead_s);
    drift_ppm_ = fault.drift_ppm;
  }
  /// Its UTC is this now, and runs on from there.
  void set_utc(UtcTime utc) {
    since_ = events_.now();
    ahead_ = Duration{utc.ns - kUtc - since_.ns};
    drift_ppm_ = 0;
  }
  [[nodiscard]] Now now() const {
    constexpr std::int64_t kMillion = 1'000'000;
    const Duration drift{(events_.now().ns - since_.ns) / kMillion * drift_ppm_};
    return {events_.now(), UtcTime{kUtc} + Duration{events_.now().ns} + ahead_ + drift};
  }

  static constexpr std::int64_t kUtc = 1'800'000'000'000'000'000;

 private:
  const Events& events_;
  MonotonicTime since_;
  Duration ahead_{0};
  std::int64_t drift_ppm_ = 0;
};

}  // namespace trb::world
