#include <algorithm>
#include <array>

#include "common/sqlite/migrate.hpp"
#include "services/cloud-gateway/io/store/history_store.hpp"
#include "services/cloud-gateway/io/store/in_order.hpp"
#include "services/cloud-gateway/io/store/private_file.hpp"

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

/// What a batch may remove: more than it adds, and bounded, so that a new bound takes a while instead of a stall.
constexpr std::int64_t kStep = 2000;
constexpr int kMaxSteps = 20;

class HistoryFile final : public HistoryStore {
 public:
  HistoryFile(std::unique_ptr<SqliteFile> file, const HistoryLimits& limits)
      : file_(std::move(file)), limits_(limits) {}

  Status add(const std::vector<HistoryEntry>& entries, UtcTime now) override {
    return file_->transact([&] {
      return in_order([&] { return insert(entries); }, [&] { return remove_old(now); },
                      [&] { return remove_excess(); });
    });
  }
  Result<HistoryPage> find(const HistoryQuery& query) override;

 private:
  Status insert(const std::vector<HistoryEntry>& entries);
  Status remove_old(UtcTime now);
  Status remove_excess();
  Status number_of(const char* sql, std::int64_t& out);

  std::unique_ptr<SqliteFile> file_;
  HistoryLimits limits_;
};

Status HistoryFile::insert(const std::vector<HistoryEntry>& entries) {
  for (const HistoryEntry& one : entries) {
    const Status done = file_->run(
        "INSERT INTO history(time, node, sensor, kind, about, value, detail) VALUES(?,?,?,?,?,?,?)", one.time.ns,
        one.node, one.sensor, static_cast<std::uint32_t>(one.kind), one.about, one.value, one.detail);
    if (!done) return done;
  }
  return Done{};
}

/// The oldest ones up to the first that is young enough: a clock that jumped costs no search.
Status HistoryFile::remove_old(UtcTime now) {
  const std::int64_t end = (now - limits_.age).ns;
  for (int i = 0; i < kMaxSteps; ++i) {
    std::int64_t last = 0;
    std::int64_t count = 0;
    bool is_old = true;
    const Status read = file_->rows(
        "SELECT number, time FROM history ORDER BY number LIMIT ?",
        [&](const Columns& row) -> Status {
          is_old = is_old && row.integer(1) < end;
          if (is_old) last = row.integer(0), ++count;
          return Done{};
        },
        kStep);
    if (!read || count == 0) return read;
    if (Status done = file_->run("DELETE FROM history WHERE number <= ?", last); !done) return done;
    if (count < kStep) return Done{};
  }
  return Done{};
}

Status HistoryFile::number_of(const char* sql, std::int64_t& out) {
  return file_->rows(sql, [&](const Columns& row) -> Status {
    out = row.integer(0);
    return Done{};
  });
}

/// Pages that removals have freed are used again before the file grows.
Status HistoryFile::remove_excess() {
  for (int i = 0; i < kMaxSteps; ++i) {
    std::int64_t pages = 0;
    std::int64_t unused = 0;
    std::int64_t size = 0;
    const Status read = in_order([&] { return number_of("PRAGMA page_count", pages); },
                                 [&] { return number_of("PRAGMA freelist_count", unused); },
                                 [&] { return number_of("PRAGMA page_size", size); });
    if (!read || static_cast<std::uint64_t>((pages - unused) * size) <= limits_.bytes) return read;
    const Status done = file_->run("DELETE FROM history WHERE number < (SELECT min(number) + ? FROM history)", kStep);
    if (!done || file_->changed() == 0) return done;
  }
  return Done{};
}

Result<HistoryPage> HistoryFile::find(const HistoryQuery& query) {
  HistoryPage out;
  HistoryPlace last;
  const std::int64_t any = -1;
  const Status read = file_->rows(
      "SELECT time, kind, about, value, detail, number FROM history WHERE node = ? AND sensor = ? AND time >= ? AND "
      "time <= ? AND (time, number) < (?, ?) AND (? = -1 OR kind = ?) ORDER BY time DESC, number DESC LIMIT ?",
      [&](const Columns& row) -> Status {
        if (out.entries.size() == query.most) {
          out.next = last;
          return Done{};
        }
        const std::int64_t kind = row.integer(1);
        if (kind < 0 || kind >= static_cast<std::int64_t>(enum_names(HistoryKind{}).size()))
          return file_->damaged("kind " + std::to_string(kind));
        out.entries.push_back({{row.integer(0)},
                               query.node,
                               query.sensor,
                               static_cast<HistoryKind>(kind),
                               row.text(2),
                               row.text(3),
                               row.text(4)});
        last = {row.integer(0), row.integer(5)};
        return Done{};
      },
      query.node, query.sensor, query.from, query.to, query.before.time, query.before.number,
      query.kind ? static_cast<std::int64_t>(*query.kind) : any,
      query.kind ? static_cast<std::int64_t>(*query.kind) : any, static_cast<std::int64_t>(query.most) + 1);
  if (!read) return read.error();
  return out;
}

}  // namespace

Result<std::unique_ptr<HistoryStore>> open_history_file(const std::string& path, const HistoryLimits& limits) {
  if (Status made = make_private(path); !made) return made.error();
  auto file = SqliteFile::open(path, kDamaged);
  if (!file) return file.error();
  if (Status current = migrate(**file, kHistorySteps, kNewer); !current) return current.error();
  return std::unique_ptr<HistoryStore>(std::make_unique<HistoryFile>(std::move(*file), limits));
}

}  // namespace trb::gateway
