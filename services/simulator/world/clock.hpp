// A computer's clocks: the world's time, and a UTC that may be wrong.
#pragma once

#include "services/simulator/world/events.hpp"

namespace trb::world {

class Clock {
 public:
  Clock(const Events& events, Duration ahead) : events_(events), ahead_(ahead) {}
  [[nodiscard]] Now now() const { return {events_.now(), UtcTime{kUtc} + Duration{events_.now().ns} + ahead_}; }

  static constexpr std::int64_t kUtc = 1'800'000'000'000'000'000;

 private:
  const Events& events_;
  Duration ahead_;
};

}  // namespace trb::world
