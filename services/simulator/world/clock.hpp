// A computer's clocks: the world's time, and a UTC that may be wrong.
#pragma once

#include "services/simulator/world/events.hpp"

namespace trb::world {

/// How a computer's UTC goes from now on.
struct ClockFault {
  double ahead_s = 0;          ///< of the true time; below 0: behind
  std::int64_t drift_ppm = 0;  ///< so many millionths too fast; below 0: too slow
  bool is_1970 = false;        ///< it counts from 1970, as without a battery; `ahead_s` has no part then
};

class Clock {
 public:
  explicit Clock(const Events& events) : events_(events), since_(events.now()) {}

  void set(const ClockFault& fault) {
    since_ = events_.now();
    ahead_ = fault.is_1970 ? Duration{-kUtc - since_.ns} : seconds(fault.ahead_s);
    drift_ppm_ = fault.drift_ppm;
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
