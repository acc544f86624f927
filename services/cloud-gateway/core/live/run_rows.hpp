// Rows of the runs that this node's scheduler reports.
#pragma once

#include <deque>
#include <set>
#include <string>

#include "common/actor/outbox.hpp"
#include "services/cloud-gateway/core/live/row_book.hpp"

namespace trb::gateway {

class RunRows {
 public:
  static constexpr std::size_t kMaxRuns = 1256;
  static constexpr std::size_t kMaxOver = 256;
  static constexpr std::size_t kMaxDetails = 64;

  explicit RunRows(RowBook& book) : book_(book) {}

  /// All unfinished runs. Only this table may lower a version: the scheduler has restarted.
  void take(const RunTable& table, Now now, Outbox& out);
  void take(const RunChanged& changed, Now now, Outbox& out);
  void take(RunView view, Now now, Outbox& out);
  /// The scheduler does not know this run.
  void forget(const std::string& run, Now now);
  void on_silence(Now now);

  /// Runs that left the table without a message of their end: request them.
  [[nodiscard]] const std::set<std::string>& lost() const { return lost_; }

 private:
  void put(const RunSummary& run, Now now, Outbox& out);
  void note_over(const std::string& run, Now now);
  [[nodiscard]] const RunSummary* find(const std::string& run) const;

  RowBook& book_;
  std::set<std::string> runs_;
  std::set<std::string> lost_;
  std::deque<std::string> over_;     ///< oldest first
  std::deque<std::string> details_;  ///< oldest first
};

}  // namespace trb::gateway
