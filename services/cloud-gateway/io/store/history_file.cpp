#include <array>

#include "services/cloud-gateway/io/store/history_tables.hpp"
#include "services/cloud-gateway/io/store/in_order.hpp"

namespace trb::gateway {
namespace {

// Never changed once released: a change is a further step. Numbers rise as entries come; times are UTC ns.
constexpr std::array kHistorySteps{
    R"(
CREATE TABLE history(
  number INTEGER PRIMARY KEY AUTOINCREMENT, time INTEGER NOT NULL, node TEXT NOT NULL, sensor TEXT NOT NULL,
  kind INTEGER NOT NULL, about TEXT NOT NULL, value TEXT NOT NULL, detail TEXT NOT NULL) STRICT;
CREATE INDEX history_of ON history(node, sensor, time);
)",
};
constexpr const char* kDamaged = "move it away together with its -wal and -shm files: a new one is begun";
constexpr const char* kNewer = "start the build that wrote it, or move it away: a new one is begun";

class HistoryFile final : public HistoryTables {
 public:
  using HistoryTables::HistoryTables;

 protected:
  [[nodiscard]] std::string size_column() const override {
    std::string out = "144";
    for (const char* text : {"node", "node", "sensor", "sensor", "about", "value", "detail"})
      out += std::string(" + length(CAST(") + text + " AS BLOB))";
    return out;
  }

  /// Pages that removals have freed are used again before the file grows.
  Status used(std::uint64_t& bytes) override {
    std::int64_t pages = 0;
    std::int64_t unused = 0;
    std::int64_t size = 0;
    const Status read = in_order([&] { return number_of("PRAGMA page_count", pages); },
                                 [&] { return number_of("PRAGMA freelist_count", unused); },
                                 [&] { return number_of("PRAGMA page_size", size); });
    bytes = static_cast<std::uint64_t>((pages - unused) * size);
    return read;
  }
};

class LateHistory final : public HistoryStore {
 public:
  LateHistory(std::string path, const HistoryLimits& limits) : path_(std::move(path)), limits_(limits) {}

  Status add(const std::vector<HistoryEntry>& entries, UtcTime now) override {
    if (Status there = open(); !there) return there;
    return store_->add(entries, now);
  }
  Result<HistoryPage> find(const HistoryQuery& query) override {
    if (Status there = open(); !there) return there.error();
    return store_->find(query);
  }

 private:
  Status open() {
    if (store_) return Done{};
    auto opened = open_history_file(path_, limits_);
    if (!opened) return opened.error();
    store_ = std::move(*opened);
    return Done{};
  }

  std::string path_;
  HistoryLimits limits_;
  std::unique_ptr<HistoryStore> store_;
};

}  // namespace

std::unique_ptr<HistoryStore> history_file(std::string path, const HistoryLimits& limits) {
  return std::make_unique<LateHistory>(std::move(path), limits);
}

Result<std::unique_ptr<HistoryStore>> open_history_file(const std::string& path, const HistoryLimits& limits) {
  auto sql = open_sqlite(path, kHistorySteps, {kDamaged, kNewer});
  if (!sql) return sql.error();
  return std::unique_ptr<HistoryStore>(std::make_unique<HistoryFile>(std::move(*sql), limits));
}

}  // namespace trb::gateway
