// When the end of a step has to look at a run: if something may have changed it, and when its time has come.
#pragma once

#include <optional>

#include "common/base/time.hpp"

namespace trb::scheduler {

class NextVisit {
 public:
  /// Something may change the run: the next end of a step looks at it.
  void touch() { is_touched_ = true; }
  /// It was looked at. `again`: at the next step, too. `at`, `end`: its next deadline, and when its time, by the steady
  /// time, is up next.
  void set(bool again, std::optional<MonotonicTime> at, std::optional<UtcTime> end) {
    is_touched_ = again;
    at_ = at;
    end_ = end;
  }

  [[nodiscard]] bool is_due(MonotonicTime now, UtcTime steady) const {
    return is_touched_ || (at_ && *at_ <= now) || (end_ && *end_ <= steady);
  }
  /// What it was last set to.
  [[nodiscard]] std::optional<MonotonicTime> at() const { return at_; }
  [[nodiscard]] std::optional<UtcTime> end() const { return end_; }

 private:
  bool is_touched_ = true;
  std::optional<MonotonicTime> at_;
  std::optional<UtcTime> end_;
};

}  // namespace trb::scheduler
