// The history's table by any Sql: what a file and a shared database have in common.
#pragma once

#include <optional>

#include "services/cloud-gateway/core/history/history_sizes.hpp"
#include "services/cloud-gateway/io/store/history_store.hpp"
#include "services/cloud-gateway/io/store/sql.hpp"

namespace trb::gateway {

class HistoryTables : public HistoryStore {
 public:
  HistoryTables(std::unique_ptr<Sql> sql, const HistoryLimits& limits) : sql_(std::move(sql)), limits_(limits) {}

  Status add(const std::vector<HistoryEntry>& entries, UtcTime now) override;
  Result<HistoryPage> find(const HistoryQuery& query) override;

 protected:
  /// What a batch may remove: more than it adds, and bounded, so that a new bound takes a while instead of a stall.
  static constexpr std::int64_t kStep = 2000;
  static constexpr int kMaxSteps = 20;

  /// Which of them this gateway writes; within the transaction.
  virtual Result<std::vector<HistoryEntry>> own(const std::vector<HistoryEntry>& entries) { return entries; }
  /// How much is used, by entries that are there.
  virtual Status used(std::uint64_t& bytes) = 0;
  /// About what an entry takes with its indexes, as an expression of its row. size_of() is the same.
  [[nodiscard]] virtual std::string size_column() const = 0;
  Status number_of(const char* query, std::int64_t& out);
  [[nodiscard]] Sql& sql() { return *sql_; }

 private:
  Result<HistoryPage> find_some(const HistoryQuery& query);
  Status insert(const std::vector<HistoryEntry>& entries);
  Status remove_old(UtcTime now);
  Status remove_excess();
  Status remove(const std::string& which, std::span<const SqlValue> values, std::int64_t& count);
  Status remove_of(const HistoryStream& stream, std::int64_t& count);
  Status count_sizes();

  std::unique_ptr<Sql> sql_;
  HistoryLimits limits_;
  std::optional<HistorySizes> sizes_;  ///< once there was too much; what another gateway writes is not in them
  int removals_ = 0;                   ///< since they were counted
};

}  // namespace trb::gateway
