// Keeps every alert.
#pragma once

#include <functional>
#include <map>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "common/base/result.hpp"
#include "common/base/time.hpp"
#include "proto/bodies/resilience.hpp"

namespace trb::resilience {

/// OPEN, EXPIRED or RELEASING: something still has to be done. DECIDED and CLOSED are final.
[[nodiscard]] bool is_open(const Alert& alert);

class AlertBook {
 public:
  static constexpr std::size_t kMaxOpen = 256;
  static constexpr std::size_t kMaxLone = 64;         ///< of those, without a run
  static constexpr std::size_t kMaxLoneOfRobot = 16;  ///< of those, one robot's: it may report any number of faults
  static constexpr std::size_t kMaxOfRobot = 64;      ///< one robot's of runs that one node has submitted
  static constexpr std::size_t kMaxOfSubmitter = 64;  ///< of one member's runs: they may name anybody, or nobody
  static constexpr std::size_t kMaxDone = 200;        ///< DECIDED and CLOSED: the oldest are removed
  static constexpr std::size_t kMaxTable = 256;

  /// Who has submitted that run; empty: not known.
  using SubmitterOf = std::function<std::string_view(const std::string& run)>;

  explicit AlertBook(SubmitterOf submitter_of = {}) : submitter_of_(std::move(submitter_of)) {}
  AlertBook(const AlertBook&) = delete;  ///< a copy's pointers would lead into the original
  AlertBook& operator=(const AlertBook&) = delete;

  void restore(Alert alert) { put(std::move(alert)); }
  /// Gives it an id. `trusted`: the runs of its run's submitter may have any number. nullptr: there is no room:
  /// kMaxOpen are open, or kMaxLone of its kind, or its robot or its run's submitter has its share.
  Alert* add(Alert alert, bool trusted = true);
  /// Removes an alert that was never recorded.
  void drop(const std::string& id);
  [[nodiscard]] Alert* find(std::string_view id);
  /// Finds an alert by a unique beginning of its id. Errors: unknown_target, bad_value (several).
  Result<Alert*> choose(const std::string& beginning);
  /// Can another alert without a run be added, of that robot?
  [[nodiscard]] bool has_room_for_lone(const std::string& robot);
  /// By time, then id.
  std::vector<Alert*> open();
  /// Newest first, kMaxTable at most: open ones before the others. With fewer proposals each, if it would not fit into
  /// a message.
  [[nodiscard]] AlertTable table(bool all) const;
  void prune();

 private:
  void put(Alert alert);
  [[nodiscard]] bool has_room_of_run(const Alert& fresh, bool trusted);
  [[nodiscard]] std::string_view submitter_of(const std::string& run) const;

  /// Removes the alerts that are no longer open from open_.
  void follow();

  SubmitterOf submitter_of_;
  std::map<std::string, Alert, std::less<>> alerts_;
  std::vector<Alert*> open_;  ///< by time, then id: each view is compared with these only
  std::uint64_t count_ = 0;
};

}  // namespace trb::resilience
