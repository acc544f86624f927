// Which of the watched runs have to be looked at now.
#pragma once

#include <map>
#include <optional>
#include <set>
#include <string>
#include <string_view>
#include <utility>

#include "common/base/time.hpp"

namespace trb::resilience {

/// A run is due when something that it depends on has changed, or at a time that changes its state: a task is late, a
/// robot has been away for long, the run ends soon. Every other run is unchanged.
class DueRuns {
 public:
  /// Something about the run has changed: it is due at once.
  void notify(const std::string& run) { notified_.insert(run); }
  /// When the run is due though nothing changes; nothing: never. Replaces the previous time.
  void schedule(const std::string& run, std::optional<MonotonicTime> at);
  /// The run is due then, or at its previous time, whichever comes first.
  void hasten(const std::string& run, std::optional<MonotonicTime> at);
  /// The runs that are due, by id. They are no longer due, and have no time.
  std::set<std::string> take(MonotonicTime now);

  /// Is a run due because something has changed?
  [[nodiscard]] bool has_notified() const { return !notified_.empty(); }
  /// The earliest time of any run; nothing: none has one.
  [[nodiscard]] std::optional<MonotonicTime> next() const;

 private:
  std::set<std::string> notified_;
  std::map<std::string, MonotonicTime> moments_;             ///< by run
  std::set<std::pair<MonotonicTime, std::string>> by_time_;  ///< the same, the next one first
};

}  // namespace trb::resilience
