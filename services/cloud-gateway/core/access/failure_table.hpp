// Failed tries for each of many keys, in bounded memory.
#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <string_view>

#include "common/base/time.hpp"

namespace trb::gateway {

struct FailureRule {
  std::uint32_t free = 5;   ///< failures without a wait
  Duration most{};          ///< the longest wait; the first is 1 s, then twice as long each time
  std::size_t room = 4096;  ///< keys
};

/// After this time without a try a key is forgotten.
constexpr Duration kForgetFailures = std::chrono::hours(1);

/// A full table drops the key with the fewest failures; of several, the one tried longest ago. To push a key out, an
/// attacker has to fail as often with every other key.
class FailureTable {
 public:
  explicit FailureTable(FailureRule rule) : rule_(rule) {}

  /// How long this key has to wait; 0: no wait.
  [[nodiscard]] Duration wait(std::string_view key, MonotonicTime now) const;
  /// Counts a try as a failure when it begins, so that parallel tries count too.
  void count(std::string_view key, MonotonicTime now);
  /// One try was no failure. Does nothing for a key that was dropped.
  void take_back(std::string_view key);

  [[nodiscard]] std::size_t size() const { return rows_.size(); }

 private:
  struct Row {
    std::uint32_t failures = 0;
    MonotonicTime last;
  };
  [[nodiscard]] Duration wait_after(std::uint32_t failures) const;
  void make_room(MonotonicTime now);

  FailureRule rule_;
  std::map<std::string, Row, std::less<>> rows_;
};

}  // namespace trb::gateway
