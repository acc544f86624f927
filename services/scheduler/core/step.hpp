// One step of the core: its moment, and where its effects go.
#pragma once

#include "common/actor/outbox.hpp"
#include "common/base/time.hpp"

namespace trb::scheduler {

/// `steady` is what times to live count by.
struct Clock {
  MonotonicTime mono;
  UtcTime steady;
};

struct Step {
  Now now;
  Outbox& out;
  UtcTime steady;
  [[nodiscard]] Clock clock() const { return {now.mono, steady}; }
};

}  // namespace trb::scheduler
