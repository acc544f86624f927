// Changes of rows become entries of the history, which its owner writes in batches.
#pragma once

#include <map>
#include <optional>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "common/base/write_share.hpp"
#include "services/cloud-gateway/core/history/history_entry.hpp"
#include "services/cloud-gateway/core/live/row_book.hpp"

namespace trb::gateway {

/// A robot's states are recorded at each change, its values (battery, pose ...) every 5 s at most, the newest then.
/// Readings are recorded as they come: a stream has ten a second at most. What changes more often than a
/// robot's shares of states, tasks and readings allow is left out, counted, and told. What waits is bounded:
/// nobody may have more of it than is still free, so others' entries find room.
class HistoryRecorder final : public RowObserver {
 public:
  static constexpr Duration kFlush = std::chrono::milliseconds(500);  ///< what a kill may cost, and the time to write
  static constexpr Duration kValue = std::chrono::seconds(5);
  static constexpr std::size_t kMaxWaiting = 20'000;
  static constexpr std::size_t kMaxText = 1024;
  static constexpr std::int64_t kTasks = 512;  ///< of one robot at once: some runs may begin and end together
  static constexpr Duration kEachTask = std::chrono::seconds(1);
  static constexpr std::int64_t kReadings = 2000;  ///< of one node's sensors at once
  static constexpr Duration kEachReading = std::chrono::milliseconds(5);
  static constexpr std::size_t kMaxShares = 4096;

  void changed(const Row& row, const RowContent& before, Now now) override;
  /// Values whose 5 s are over.
  void tick(Now now);
  [[nodiscard]] bool is_due(Now now) const { return since_ && now.mono - *since_ >= kFlush; }
  [[nodiscard]] std::optional<MonotonicTime> next_deadline() const;
  std::vector<HistoryEntry> take();
  /// A batch that could not be written.
  void count_lost(std::uint64_t entries) { lost_ += entries; }
  [[nodiscard]] std::uint64_t lost() const { return lost_; }
  /// How many entries of whom were left out since the last call; counted in lost() already.
  std::map<std::string, std::uint64_t> take_left_out() { return std::exchange(left_out_, {}); }

 private:
  struct Shares {
    WriteShare of_states;
    WriteShare of_tasks{kTasks, kEachTask};
    WriteShare of_readings{kReadings, kEachReading};
    WriteShare& of(HistoryKind kind) {
      return kind == HistoryKind::task ? of_tasks : kind == HistoryKind::reading ? of_readings : of_states;
    }
  };
  struct Value {
    MonotonicTime recorded;
    std::optional<HistoryEntry> waiting{};
  };
  using ValueKey = std::pair<std::string, std::string>;  ///< the robot and the value's name

  void on_node(const Row& row, const NodeRow& node, const RowContent& before, Now now);
  void on_robot(const Row& row, const RobotRow& robot, const RobotRow& before, Now now);
  void on_faults(const Row& row, const RobotRow& robot, const RobotRow& before, Now now);
  void on_use(const Row& row, const RobotRow& robot, const RobotRow& before, Now now);
  void on_values(const Row& row, const RobotRow& robot, const RobotRow& before, Now now);
  void on_run(const RunView& run, const RowContent& before, Now now);
  void on_reading(const Row& row, const SensorReading& reading, Now now);
  void forget(const std::string& robot);
  void add_within_share(HistoryEntry entry, Now now);
  void add(HistoryEntry entry, Now now);
  void leave_out(const std::string& node);

  std::vector<HistoryEntry> waiting_;
  std::optional<MonotonicTime> since_;  ///< the oldest that waits
  std::map<ValueKey, Value> values_;
  std::set<std::pair<MonotonicTime, ValueKey>> due_;
  std::map<std::string, Shares> shares_;
  std::map<std::string, std::size_t> waiting_of_;  ///< by node
  std::map<std::string, std::uint64_t> left_out_;
  std::uint64_t lost_ = 0;
};

/// The runs whose tasks are recorded: under way, and not too large to be requested at each of their changes.
std::set<std::string> recorded_runs(const RowBook& book);

}  // namespace trb::gateway
