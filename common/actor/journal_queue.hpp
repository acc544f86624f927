// A service's records on their way to its journal: those that may wait go with the next commit, and cost none of their
// own.
#pragma once

#include <algorithm>
#include <optional>
#include <utility>
#include <vector>

#include "common/actor/outbox.hpp"
#include "common/base/time.hpp"

namespace trb {

class JournalQueue {
 public:
  /// A record waits so long at most.
  static constexpr Duration kLongest = std::chrono::seconds(10);

  /// Takes a step's records in, behind those that wait. True: they are to be committed (take()) before anything of the
  /// step is sent.
  [[nodiscard]] bool add(std::vector<Journal> records, MonotonicTime now) {
    const bool is_urgent = std::ranges::any_of(records, [](const Journal& one) { return !one.may_wait; });
    if (!records.empty() && !due_) due_ = now + kLongest;
    if (records_.empty()) {
      records_ = std::move(records);
    } else {
      std::ranges::move(records, std::back_inserter(records_));
    }
    return is_urgent;
  }
  /// When what waits is to be committed in any case; empty: nothing waits.
  [[nodiscard]] std::optional<MonotonicTime> due() const { return due_; }
  /// All that waits, in the order in which it was recorded, for one commit.
  [[nodiscard]] std::vector<Journal> take() {
    due_.reset();
    return std::exchange(records_, {});
  }

 private:
  std::vector<Journal> records_;
  std::optional<MonotonicTime> due_;
};

}  // namespace trb
