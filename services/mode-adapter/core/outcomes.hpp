// The outcomes of attempts: kept until the scheduler has journaled them, then as long as there is room.
#pragma once

#include <map>
#include <optional>

#include "common/base/time.hpp"
#include "proto/bodies/robot.hpp"

namespace trb::adapter {

class Outcomes {
 public:
  [[nodiscard]] const Outcome* find(const AttemptKey& key) const;

  /// Makes room for one more by removing the oldest acknowledged one. False: all still wait to be journaled.
  bool make_room();
  void add(Outcome outcome, Now now);
  void acknowledge(const AttemptKey& key);
  /// One of the last kPatience is not acknowledged: lost with this process, nobody would know how the task ended.
  [[nodiscard]] bool wait(Now now) const;

  /// Calls `send` for every outcome that was last sent a second ago or more. True: it was time for that.
  template <class Send>
  bool resend(Now now, Send send) {
    if (!resend_at_ || now.mono < *resend_at_) return false;
    for (const auto& [key, kept] : kept_) {
      if (!kept.acknowledged) send(kept.outcome);
    }
    resend_at_ = waiting_ == 0 ? std::nullopt : std::optional(now.mono + kResend);
    return true;
  }
  [[nodiscard]] std::optional<MonotonicTime> next_deadline() const { return resend_at_; }

 private:
  static constexpr Duration kResend = std::chrono::seconds(1);
  /// A scheduler that has not journaled it by then is not there: the process that ends does not wait for it any more.
  static constexpr Duration kPatience = std::chrono::seconds(30);
  struct Kept {
    Outcome outcome;
    std::uint64_t order = 0;
    MonotonicTime since{};
    bool acknowledged = false;
  };

  std::map<AttemptKey, Kept> kept_;
  std::uint64_t order_ = 0;
  std::size_t waiting_ = 0;
  std::optional<MonotonicTime> resend_at_;
};

}  // namespace trb::adapter
