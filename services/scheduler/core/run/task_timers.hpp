// When tasks of a run may be tried again, since when they are due or want a robot, and when the decider passes them on
// itself.
#pragma once

#include <map>
#include <optional>
#include <vector>

#include "common/base/time.hpp"
#include "common/scenario/graph.hpp"

namespace trb::scheduler {

class TaskTimers {
 public:
  using Times = std::map<TaskIndex, MonotonicTime>;

  void retry_at(TaskIndex task, MonotonicTime at) { retry_at_[task] = at; }
  /// Its robot still waits before it tries again.
  [[nodiscard]] bool waits(TaskIndex task) const { return retry_at_.contains(task); }
  [[nodiscard]] std::optional<TaskIndex> first_that_waits() const {
    return retry_at_.empty() ? std::nullopt : std::optional(retry_at_.begin()->first);
  }
  void drop_retry(TaskIndex task) { retry_at_.erase(task); }
  /// The run is over: nothing is tried again.
  void drop_retries() { retry_at_.clear(); }
  /// It is worked out anew what is due, if there were some.
  void drop_past_retries(MonotonicTime now);

  /// True once for each new version of the facts: what is due is worked out anew only then.
  bool take_version(std::uint64_t version);
  /// It was the last one that was taken.
  [[nodiscard]] bool are_of(std::uint64_t version) const { return version_ == version; }
  /// Exactly these are due; those that were before keep their time.
  void set_due(std::vector<TaskIndex> tasks, MonotonicTime now);
  template <class Match>
  void drop_due_if(const Match& match) {
    std::erase_if(due_since_, [&](const auto& one) { return match(one.first); });
  }
  /// Neither is due, nor wants a robot: the run is held, or over.
  void drop_all_due() {
    due_since_.clear();
    unbound_since_.clear();
  }
  /// Since when each is due, as far as this node has seen.
  [[nodiscard]] const Times& due_since() const { return due_since_; }
  [[nodiscard]] bool is_due(TaskIndex task) const { return due_since_.contains(task); }
  /// It was due for longer than `within_s`; 0: it may wait for ever.
  [[nodiscard]] bool is_late(TaskIndex task, double within_s, MonotonicTime now) const;

  /// Exactly these want a robot that the decider has to choose; those that did before keep their time.
  void set_unbound(std::vector<TaskIndex> tasks, MonotonicTime now);
  [[nodiscard]] const Times& unbound_since() const { return unbound_since_; }

  /// Exactly these are passed on by the decider itself at `at`; those that were before keep their time.
  void set_passes(std::vector<TaskIndex> tasks, MonotonicTime at);
  /// Those to be passed on now; their next time is `again`.
  std::vector<TaskIndex> take_due_passes(MonotonicTime now, MonotonicTime again);

  /// Of retries and passes; due tasks have no time of their own.
  [[nodiscard]] std::optional<MonotonicTime> next() const;

 private:
  Times retry_at_;
  Times pass_at_;
  Times due_since_;
  Times unbound_since_;
  std::optional<std::uint64_t> version_;
};

}  // namespace trb::scheduler
