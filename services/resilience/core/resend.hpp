#pragma once

#include "common/base/resend_timer.hpp"

namespace trb::resilience {

/// For what is sent again until it is answered: at once, then after 0.2 s, doubled up to 5 s.
inline ResendTimer resend_timer() {
  return {std::chrono::milliseconds(200), std::chrono::seconds(5)};
}

}  // namespace trb::resilience
