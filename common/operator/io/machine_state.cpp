#include "common/operator/io/machine_state.hpp"

#include <sys/timex.h>

namespace trb::op {

std::optional<bool> is_clock_set() {
  timex asked{};
  if (::adjtimex(&asked) == -1) return std::nullopt;
  return (asked.status & STA_UNSYNC) == 0;
}

}  // namespace trb::op
