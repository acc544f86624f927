// What an attacker's unfinished messages filled goes back to the system. Of many small parts glibc keeps the freed
// pages in its heaps, for good, if one block behind them is in use.
#pragma once

#include <malloc.h>

#include <cstdint>
#include <optional>

#include "common/base/time.hpp"

namespace trb::router {

class MemoryReturn {
 public:
  /// From then on large blocks go back as they are freed. By default glibc raises the first bound to the size of a
  /// freed block, and keeps messages of that size.
  static void set_up() {
    ::mallopt(M_MMAP_THRESHOLD, 128 << 10);
    ::mallopt(M_TRIM_THRESHOLD, 128 << 10);
  }

  /// `cut` counts the connections that were cut. Small blocks go back a second behind the first new one, when libzmq's
  /// threads have freed them, and thus once a second at most. Returns whether they went.
  bool look(MonotonicTime now, std::uint64_t cut) {
    if (cut != seen_ && !due_) due_ = now + kFreed;
    seen_ = cut;
    if (!due_ || now < *due_) return false;
    due_.reset();
    ::malloc_trim(0);
    return true;
  }

 private:
  static constexpr Duration kFreed = std::chrono::seconds(1);
  std::uint64_t seen_ = 0;
  std::optional<MonotonicTime> due_;
};

}  // namespace trb::router
