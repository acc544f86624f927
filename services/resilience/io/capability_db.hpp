// capability.db: what the fleet can do, as it is kept over restarts; alerts and decisions beside it.
//
// How durable: what write(), put_… and set_… have answered with Done is on disk (WAL, synchronous=FULL). Of a Fleet's
// changes, those that are `urgent()` (who is there, what it can do, faults, history) are to be written before anything
// is said of them; values (battery, position) are told again and may be written together every few seconds: a power cut
// loses that long, and their times say how old they are.
#pragma once

#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "services/resilience/core/fleet.hpp"
#include "services/resilience/core/history_reader.hpp"
#include "services/resilience/io/sqlite.hpp"

namespace trb::resilience {

/// An alert as its owner stores it: the body is not looked into here.
struct AlertRow {
  std::string id;
  UtcTime time;
  std::int64_t state = 0;
  Bytes body;
  bool operator==(const AlertRow&) const = default;
};

struct DecisionRow {
  std::string run;
  std::uint32_t epoch = 0;
  Bytes record;
  bool delivered = false;
  bool operator==(const DecisionRow&) const = default;
};

class CapabilityDb final : public HistoryReader {
 public:
  static constexpr std::int64_t kMaxHistory = 10'000;                   ///< rows; the oldest go
  static constexpr Duration kHistoryAge = std::chrono::hours(30 * 24);  ///< and what is older

  /// Opens or makes the file, brings it to this build's version. Errors: io_error, malformed (no database, a damaged
  /// one), version_mismatch (of a newer build); each names the file and the hint.
  static Result<std::unique_ptr<CapabilityDb>> open(const std::string& path);

  /// Fills an empty fleet with what is kept. Errors: malformed, io_error, and those of Fleet::restore.
  Status load(Fleet& fleet);

  /// Writes what has changed, in one transaction, and then tells the fleet so. On an error (io_error: the disk is full,
  /// say) nothing is written, and all of it is still to be.
  Status write(Fleet& fleet, UtcTime now);

  /// The newest entries, of one robot or (empty) of all; the newest first.
  Result<std::vector<HistoryEntry>> history(const std::string& robot, std::uint32_t most) override;

  Status put_alert(const AlertRow& alert);  /// Of the alerts with one of these two states only the newest stay.
  Status keep_newest_alerts(std::int64_t state, std::int64_t other, std::int64_t most);
  Result<std::vector<AlertRow>> alerts();  ///< by time, then id

  /// Error: conflict (another record of that run and epoch is there: a decision is never replaced).
  Status put_decision(const DecisionRow& decision);
  Status set_delivered(const std::string& run, std::uint32_t epoch);
  Status drop_decision(const std::string& run, std::uint32_t epoch);
  Status drop_decisions(const std::string& run);
  Result<std::vector<DecisionRow>> decisions();  ///< by run, then epoch

  /// What `work` does to this database happens whole or not at all: an alert and its decision, say.
  Status transact(const std::function<Status()>& work) { return file_->transact(work); }

 private:
  explicit CapabilityDb(std::unique_ptr<SqliteFile> file) : file_(std::move(file)) {}
  Status write_changes(const Fleet& fleet, UtcTime now);
  Status prune_history(UtcTime now);

  std::unique_ptr<SqliteFile> file_;
};

}  // namespace trb::resilience
