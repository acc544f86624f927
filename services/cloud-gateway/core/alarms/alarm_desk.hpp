// Alarms as people handle them: acknowledged, shelved for a while, chattering, the first of several.
#pragma once

#include <map>
#include <string>
#include <vector>

#include "common/base/result.hpp"
#include "common/base/steady_time.hpp"
#include "services/cloud-gateway/core/access/change_list.hpp"
#include "services/cloud-gateway/core/alarms/alarm.hpp"

namespace trb::gateway {

constexpr std::size_t kMaxShelves = 256;
constexpr Duration kShortestShelf = std::chrono::minutes(1);
constexpr Duration kLongestShelf = std::chrono::hours(8);  ///< a shift: the next one decides for itself
constexpr std::size_t kMaxShelfReason = 255;
constexpr Duration kForgottenAfter = std::chrono::hours(24 * 7);
/// Alarms of one run that come so soon after its first are taken for its consequences.
constexpr Duration kFollowsWithin = std::chrono::seconds(60);

/// An alert:
/// new          | acknowledged                        | acknowledged, by the first who did
/// new          | its source chatters, and was acknowledged before | acknowledged, by the same person
/// acknowledged | its severity rises                  | new
/// any          | it has left the table               | forgotten
/// acknowledged | it was in no table for 7 days       | forgotten; till then another gateway's node may have it
/// A source:
/// -       | shelved                        | shelved: its alerts are listed apart, and call nobody
/// shelved | shelved anew                   | shelved, with the new end and reason
/// shelved | unshelved, or its end has come | -
/// Shelves end by steady UTC, chatter by the alerts' own times.
class AlarmDesk {
 public:
  /// All rows of the store, in the place of what is known; own changes that are not taken yet stay. Adds no change.
  void replace(const std::vector<Acknowledgement>& rows);
  void replace(const std::vector<Shelf>& rows);
  /// This alert is known to be acknowledged, at that severity or a higher one.
  [[nodiscard]] bool has(const Acknowledgement& one) const;
  [[nodiscard]] bool has_shelf(const std::string& source) const { return shelves_.contains(source); }

  /// The resilience's whole table.
  void see(const std::vector<Alert>& alerts, UtcTime now);
  /// Ends the shelves whose time has come.
  void tick(UtcTime steady);
  /// The clock has stepped: a shelf lasts for as long as was wished.
  void move(const SteadyStep& step);

  /// Errors of all: unknown_target (no such alert). A repeat does nothing.
  Status acknowledge(const std::string& alert, const std::string& who, UtcTime now);
  /// Errors besides: bad_value (time, reason), queue_full.
  Status shelve(const std::string& alert, const std::string& who, Duration time, const std::string& why,
                UtcTime steady);
  /// Errors besides: conflict (it is not shelved).
  Status unshelve(const std::string& alert);

  /// Of an alert of the last table.
  [[nodiscard]] Alarm of(const std::string& alert) const;

  std::vector<Change<Acknowledgement>> take_acknowledged() { return acknowledged_changes_.take(); }
  std::vector<Change<Shelf>> take_shelves() { return shelf_changes_.take(); }
  /// Those that ended by themselves since the last call, for the record.
  std::vector<Shelf> take_ended() { return std::exchange(ended_, {}); }

 private:
  struct Known {
    Severity severity{};
    std::string source;
    std::uint32_t times = 0;  ///< 0: it does not chatter
    std::string first;
    UtcTime came;  ///< when its coming began
  };
  [[nodiscard]] Result<const Known*> find(const std::string& alert) const;
  void put(Acknowledgement one);
  void drop_acknowledged(const std::string& alert);
  void take_over(const std::vector<Alert>& alerts, const std::map<std::string, Known>& before, UtcTime now);
  [[nodiscard]] bool is_over(const Acknowledgement& one, const std::map<std::string, Known>& before, UtcTime now) const;

  std::map<std::string, Known> known_;  ///< by alert
  std::map<std::string, Acknowledgement> acknowledged_;
  std::map<std::string, Shelf> shelves_;
  std::vector<Shelf> ended_;
  ChangeList<Acknowledgement> acknowledged_changes_;
  ChangeList<Shelf> shelf_changes_;
};

}  // namespace trb::gateway
