// Tasks that should have ended or begun by now: how long each has had its state, since this node first saw it.
#pragma once

#include <functional>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "services/resilience/core/fleet.hpp"
#include "services/resilience/core/watched_run.hpp"

namespace trb::resilience {

class Overdue {
 public:
  static constexpr Duration kStart = std::chrono::seconds(30);   ///< a task should begin this long after it was due
  static constexpr Duration kMargin = std::chrono::seconds(10);  ///< beyond a time-out, or half of it
  static constexpr Duration kRule = std::chrono::seconds(5);     ///< beyond `start_within_s`
  static constexpr Duration kLook = std::chrono::seconds(10);    ///< at a robot that does a task of another run
  /// For this long a robot is believed that it does a task of another run, though no view shows that.
  static constexpr Duration kBelieved = std::chrono::minutes(10);

  struct Late {
    std::size_t task = 0;
    std::string text;
  };

  using Runs = std::map<std::string, WatchedRun, std::less<>>;

  /// Looks at the run's tasks. Those in `told` were overdue before this service started. `runs`: those that are open
  /// here. The run is_known().
  void follow(const WatchedRun& run, const std::set<std::string>& told, const Runs& runs, const Fleet& fleet, Now now);
  void forget(std::string_view run);

  /// What the view shows as overdue, in the order of the tasks; nothing of a run that is held.
  [[nodiscard]] std::vector<Late> late(const WatchedRun& run, const Fleet& fleet) const;
  /// Due, not begun within its `start_within_s`, and its scenario allows to skip it (on_failure skip or continue).
  [[nodiscard]] std::vector<std::size_t> to_skip(const WatchedRun& run) const;
  /// Would something be overdue now if it still is as the view shows it? Only a view requested from now on can tell.
  [[nodiscard]] bool wants_view(const WatchedRun& run, const Fleet& fleet, Now now) const;
  /// It was decided: it is not reported again while it stays as it is.
  void ruled(const WatchedRun& run, std::size_t task);
  /// When the run's next task will be overdue.
  [[nodiscard]] std::optional<MonotonicTime> next(const WatchedRun& run, const Fleet& fleet, Now now) const;

 private:
  enum class Phase : std::uint8_t { none, due, begun };
  struct Entry {
    Phase phase{};
    std::string robot;
    std::uint32_t attempt = 0;
    MonotonicTime since;
    bool told = false;
    bool ruled = false;
    bool robot_works = false;                   ///< due: its robot does another task, of this run or another
    MonotonicTime free_since;                   ///< due: since then it does none
    std::optional<MonotonicTime> claims_since;  ///< due: when it first said so, and no view showed it
  };
  static Phase phase_of(const WatchedRun& run, std::size_t task);
  static bool does_another(const WatchedRun& run, std::size_t task, const Runs& runs, const Fleet& fleet, Entry& entry,
                           Now now);
  static std::optional<MonotonicTime> late_at(const WatchedRun& run, std::size_t task, const Entry& entry,
                                              const Fleet& fleet);
  static std::optional<MonotonicTime> skipped_at(const WatchedRun& run, std::size_t task, const Entry& entry);
  static std::optional<Duration> limit(const WatchedRun& run, std::size_t task, const Entry& entry, const Fleet& fleet);
  static std::string text_of(const WatchedRun& run, std::size_t task, const Entry& entry, Duration limit);

  std::map<std::string, std::map<std::size_t, Entry>, std::less<>> runs_;
};

}  // namespace trb::resilience
