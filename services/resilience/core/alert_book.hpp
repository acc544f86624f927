// Every alert that is kept.
#pragma once

#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "common/base/result.hpp"
#include "common/base/time.hpp"
#include "proto/bodies/resilience.hpp"

namespace trb::resilience {

/// OPEN, EXPIRED or RELEASING: something is still to be done. What is DECIDED or CLOSED stays so.
[[nodiscard]] bool is_open(const Alert& alert);

class AlertBook {
 public:
  static constexpr std::size_t kMaxOpen = 256;
  static constexpr std::size_t kMaxLone = 64;   ///< of those, without a run: robots that report many faults at once
  static constexpr std::size_t kMaxDone = 200;  ///< DECIDED and CLOSED: the oldest go
  static constexpr std::size_t kMaxTable = 256;

  AlertBook() = default;
  AlertBook(const AlertBook&) = delete;  ///< a copy's open ones would be those of the first
  AlertBook& operator=(const AlertBook&) = delete;

  void restore(Alert alert) { put(std::move(alert)); }
  /// Makes its id. nullptr: kMaxOpen are open, or kMaxLone of its kind.
  Alert* add(Alert alert);
  /// It was never recorded.
  void drop(const std::string& id);
  [[nodiscard]] Alert* find(std::string_view id);
  /// By a unique beginning of its id. Errors: unknown_target, bad_value (several).
  Result<Alert*> choose(const std::string& beginning);
  /// Another one without a run can be added.
  [[nodiscard]] bool has_room_for_lone();
  /// By time, then id.
  std::vector<Alert*> open();
  /// Newest first, kMaxTable at most: the open ones before those that are done. With fewer proposals each, if it would
  /// not fit into a message.
  [[nodiscard]] AlertTable table(bool all) const;
  void prune();

 private:
  void put(Alert alert);

  /// Those that are over by now leave open_.
  void follow();

  std::map<std::string, Alert, std::less<>> alerts_;
  std::vector<Alert*> open_;  ///< by time, then id: each view is compared with these, and not with all that is kept
  std::uint64_t count_ = 0;
};

}  // namespace trb::resilience
