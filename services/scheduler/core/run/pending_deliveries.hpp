// What this node owes to others until they confirm that they have journaled it.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "common/base/back_off.hpp"
#include "common/base/resend_timer.hpp"
#include "common/base/time.hpp"
#include "common/scenario/graph.hpp"

namespace trb::scheduler {

/// What is sent to another node until it answers: at once, then after 0.2 s, doubled up to 2 s.
inline ResendTimer resend_timer() {
  return {seconds(0.2), seconds(2)};
}

/// Sent twice in vain: the other side is likely away.
inline bool is_slow(const ResendTimer& timer) {
  return timer.times() >= 2;
}

/// When to ask again: after kFirst, doubled up to kLongest.
class Pace {
 public:
  static constexpr Duration kFirst = std::chrono::seconds(30);
  static constexpr Duration kLongest = std::chrono::minutes(10);

  /// True if it is time; begins to count at the first call.
  bool due(MonotonicTime now);
  void reset() { *this = Pace{}; }
  [[nodiscard]] std::optional<MonotonicTime> next() const { return next_; }

 private:
  std::optional<MonotonicTime> next_;
  BackOff back_off_{kFirst, kLongest};
};

enum class DeliveryKind : std::uint8_t { baton = 0, results, abort, decision, pause };
constexpr auto enum_names(DeliveryKind) {
  return std::array<std::string_view, 5>{"baton", "results", "abort", "decision", "pause"};
}

struct PendingDelivery {
  DeliveryKind kind{};
  std::string to;
  std::vector<TaskIndex> tasks;  ///< baton: those it is for; results: those that ended; else none
  ResendTimer timer = resend_timer();
  bool is_again = false;  ///< of what take_due() gives: some of it has been sent before
};

class PendingDeliveries {
 public:
  /// No effect if it is owed already. Results are owed task by task.
  void owe(DeliveryKind kind, const std::string& to, const std::vector<TaskIndex>& tasks);
  /// The other side has journaled it; false if it was not owed (late or repeated). Results may be settled in any
  /// portion.
  bool settle(DeliveryKind kind, const std::string& to, const std::vector<TaskIndex>& tasks);
  void drop(DeliveryKind kind);
  void drop(DeliveryKind kind, const std::string& to);
  /// Every baton that is for tasks: a new epoch has its own.
  void drop_batons();

  /// What is to be sent now; it is taken as sent. Results for one node are put together: those due, and with them those
  /// that wait for a node which has been away.
  std::vector<PendingDelivery> take_due(MonotonicTime now);
  /// Everything is due again: after a restart of this service or its router.
  void restart();

  [[nodiscard]] bool empty() const { return open_.empty(); }
  /// Rises with what is owed and settled.
  [[nodiscard]] std::uint64_t changes() const { return changes_; }
  [[nodiscard]] std::optional<MonotonicTime> next() const;
  [[nodiscard]] bool owes(DeliveryKind kind, const std::string& to) const;
  /// The baton for that task is owed to somebody.
  [[nodiscard]] bool owes_baton(TaskIndex task) const;
  /// All that is owed to that node.
  [[nodiscard]] std::vector<PendingDelivery> owed_to(const std::string& node) const;
  /// To whom something of that kind is owed, in order of owing.
  [[nodiscard]] std::vector<std::string> creditors(DeliveryKind kind) const;

 private:
  template <class Match>
  bool remove(const Match& match);
  bool settle_one(DeliveryKind kind, const std::string& to, const std::vector<TaskIndex>& tasks);
  PendingDelivery gather_results(const std::string& to, MonotonicTime now);

  std::vector<PendingDelivery> open_;
  std::uint64_t changes_ = 0;
};

}  // namespace trb::scheduler
