// Where histories are kept. One thread uses a store.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "common/base/result.hpp"
#include "services/cloud-gateway/core/history/history_entry.hpp"

namespace trb::gateway {

struct HistoryLimits {
  Duration age = std::chrono::hours(24 * 30);
  std::uint64_t bytes = 256ULL << 20U;  ///< on disk, with its indexes
};

/// Of a page: 100,000 readings of a number have room, so many texts of 1 kB do not. 1,000 entries more are possible.
constexpr std::size_t kMaxHistoryBytes = 8U << 20U;

/// Errors of every call: io_error (a full disk, no rights), malformed (damaged), each with a hint. After an error the
/// object can be used further.
class HistoryStore {
 public:
  HistoryStore() = default;
  HistoryStore(const HistoryStore&) = delete;
  HistoryStore& operator=(const HistoryStore&) = delete;
  virtual ~HistoryStore() = default;

  /// All of them or none, in one transaction; then what is too old, or too much, goes, the oldest first.
  virtual Status add(const std::vector<HistoryEntry>& entries, UtcTime now) = 0;
  /// A page of over kMaxHistoryBytes ends before `most`, with `next`.
  virtual Result<HistoryPage> find(const HistoryQuery& query) = 0;
};

/// NODE_DIR/state/history.db: SQLite. Error besides: version_mismatch (a newer build wrote it).
Result<std::unique_ptr<HistoryStore>> open_history_file(const std::string& path, const HistoryLimits& limits);

/// The same; while it cannot be opened each call tries it, and returns why not. A history keeps nothing else from its
/// work: neither a damaged one, nor one without room.
std::unique_ptr<HistoryStore> history_file(std::string path, const HistoryLimits& limits);

}  // namespace trb::gateway
