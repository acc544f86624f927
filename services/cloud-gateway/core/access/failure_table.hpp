// Tries that failed, of many keys, in bounded memory.
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

/// After so long without a try a key is as one that was never heard of.
constexpr Duration kForgetFailures = std::chrono::hours(1);

/// In a full table the key with the fewest failures goes, of several the one tried longest ago: to wash a key out, one
/// has to fail as often at every other one.
class FailureTable {
 public:
  explicit FailureTable(FailureRule rule) : rule_(rule) {}

  /// How long this key has to wait; 0: it may try.
  [[nodiscard]] Duration wait(std::string_view key, MonotonicTime now) const;
  /// A try counts as a failure when it begins, so that many at once are counted too.
  void count(std::string_view key, MonotonicTime now);
  /// One was none. Of a key that was washed out: nothing.
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
