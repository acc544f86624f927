// capability.db: the fleet's capabilities, kept over restarts; alerts and decisions beside them.
//
// Durability: once write(), put_… or set_… returns Done, the data is on disk (WAL, synchronous=FULL). Of a Fleet's
// changes, those that are `urgent()` (routes, abilities, faults, history) must be written before anything based on them
// is sent. Values (battery, position) are sent again and may be written together every few seconds: a power cut loses
// those seconds, and the times show how old the values are. So it is with all changes of a robot that has used up its
// share (write_share.hpp): after a power cut its node tells its profile again.
#pragma once

#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "common/sqlite/sqlite_file.hpp"
#include "services/resilience/core/fleet.hpp"
#include "services/resilience/core/history_reader.hpp"

namespace trb::resilience {

/// An alert as its owner stores it: the body is not read here.
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
  static constexpr std::int64_t kMaxHistory =
      10'000;                                        ///< rows; the oldest of the robots that have the most are removed
  static constexpr std::int64_t kHistoryRoom = 500;  ///< so many together, for it costs a look at every row
  static constexpr Duration kHistoryAge = std::chrono::hours(30 * 24);  ///< older rows are removed

  /// Opens or creates the file, and brings it to this build's version. Errors: io_error, malformed (not a database, or
  /// damaged), version_mismatch (of a newer build); each names the file and a cure.
  static Result<std::unique_ptr<CapabilityDb>> open(const std::string& path);

  /// Fills an empty fleet from the file. Errors: malformed, io_error, and those of Fleet::restore.
  Status load(Fleet& fleet);

  /// Writes the changes in one transaction, and then marks them as written; removes what is old at `now`, which must be
  /// no clock that jumps. On an error (io_error, for example a full disk) nothing is written, and all changes are kept.
  Status write(Fleet& fleet, UtcTime now);

  /// The newest entries, of one robot or (empty) of all; the newest first.
  Result<std::vector<HistoryEntry>> history(const std::string& robot, std::uint32_t most) override;

  Status put_alert(const AlertRow& alert);
  /// Of the alerts in one of these two states only the `most` newest stay.
  Status keep_newest_alerts(std::int64_t state, std::int64_t other, std::int64_t most);
  Status drop_alert(const std::string& id);
  Result<std::vector<AlertRow>> alerts();  ///< by time, then id

  /// Error: conflict (another record of that run and epoch is there: a decision is never replaced).
  Status put_decision(const DecisionRow& decision);
  Status set_delivered(const std::string& run, std::uint32_t epoch);
  Status drop_decision(const std::string& run, std::uint32_t epoch);
  Status drop_decisions(const std::string& run);
  Result<std::vector<DecisionRow>> decisions();  ///< by run, then epoch

  /// Everything that `work` does to this database happens completely or not at all: for example an alert and its
  /// decision.
  Status transact(const std::function<Status()>& work) { return file_->transact(work); }

 private:
  explicit CapabilityDb(std::unique_ptr<SqliteFile> file) : file_(std::move(file)) {}
  Status write_changes(const Fleet& fleet, UtcTime now);
  Status prune_history(UtcTime now);

  std::unique_ptr<SqliteFile> file_;
};

}  // namespace trb::resilience
