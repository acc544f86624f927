#include "services/cloud-gateway/io/store/history_tables.hpp"

#include <algorithm>

#include "services/cloud-gateway/io/store/in_order.hpp"

namespace trb::gateway {
namespace {

constexpr std::size_t kManyRows = 64;
constexpr std::size_t kSomeRows = 8;
constexpr std::size_t kReadAtOnce = 1000;

/// As much as it takes as text: its time, and what stands between.
std::size_t size_of(const HistoryEntry& entry) {
  return 32 + entry.about.size() + entry.value.size() + entry.detail.size();
}

std::string insert_of(std::size_t rows) {
  std::string out = "INSERT INTO history(time, node, sensor, kind, about, value, detail) VALUES";
  for (std::size_t i = 0; i < rows; ++i) out += i == 0 ? "(?,?,?,?,?,?,?)" : ",(?,?,?,?,?,?,?)";
  return out;
}

}  // namespace

Status HistoryTables::add(const std::vector<HistoryEntry>& entries, UtcTime now) {
  return sql_->transact([&]() -> Status {
    const auto mine = own(entries);
    if (!mine) return mine.error();
    return in_order([&] { return insert(*mine); }, [&] { return remove_old(now); }, [&] { return remove_excess(); });
  });
}

/// Several rows a statement: a server is a way off.
Status HistoryTables::insert(const std::vector<HistoryEntry>& entries) {
  std::span<const HistoryEntry> left(entries);
  while (!left.empty()) {
    const std::size_t count = left.size() >= kManyRows ? kManyRows : left.size() >= kSomeRows ? kSomeRows : 1;
    std::vector<SqlValue> values;
    for (const HistoryEntry& one : left.first(count)) {
      values.insert(values.end(), {one.time.ns, std::string_view(one.node), std::string_view(one.sensor),
                                   static_cast<std::int64_t>(one.kind), std::string_view(one.about),
                                   std::string_view(one.value), std::string_view(one.detail)});
    }
    if (Status done = sql_->run_with(insert_of(count).c_str(), values); !done) return done;
    left = left.subspan(count);
  }
  return Done{};
}

/// The oldest ones up to the first that is young enough: a clock that jumped costs no search.
Status HistoryTables::remove_old(UtcTime now) {
  const std::int64_t end = (now - limits_.age).ns;
  for (int i = 0; i < kMaxSteps; ++i) {
    std::int64_t last = 0;
    std::int64_t count = 0;
    bool is_old = true;
    const Status read = sql_->rows(
        "SELECT number, time FROM history ORDER BY number LIMIT ?",
        [&](const SqlRow& row) -> Status {
          is_old = is_old && row.integer(1) < end;
          if (is_old) last = row.integer(0), ++count;
          return Done{};
        },
        kStep);
    if (!read || count == 0) return read;
    if (Status done = sql_->run("DELETE FROM history WHERE number <= ?", last); !done) return done;
    if (count < kStep) return Done{};
  }
  return Done{};
}

Status HistoryTables::number_of(const char* query, std::int64_t& out) {
  return sql_->rows(query, [&](const SqlRow& row) -> Status {
    out = row.integer(0);
    return Done{};
  });
}

Status HistoryTables::remove_excess() {
  for (int i = 0; i < kMaxSteps; ++i) {
    std::uint64_t bytes = 0;
    if (Status read = used(bytes); !read || bytes <= limits_.bytes) return read;
    const Status done = sql_->run("DELETE FROM history WHERE number < (SELECT min(number) + ? FROM history)", kStep);
    if (!done || sql_->changed() == 0) return done;
  }
  return Done{};
}

/// Some at a time: a server sends all that it finds, also what the page has no room for.
Result<HistoryPage> HistoryTables::find(const HistoryQuery& query) {
  HistoryPage out;
  HistoryQuery part = query;
  std::size_t size = 0;
  do {
    part.most = std::min(kReadAtOnce, query.most - out.entries.size());
    auto found = find_some(part);
    if (!found) return found.error();
    for (HistoryEntry& one : found->entries) {
      size += size_of(one);
      out.entries.push_back(std::move(one));
    }
    out.next = found->next;
    if (out.next) part.before = *out.next;
  } while (out.next && out.entries.size() < query.most && size < kMaxHistoryBytes);
  return out;
}

Result<HistoryPage> HistoryTables::find_some(const HistoryQuery& query) {
  HistoryPage out;
  HistoryPlace last;
  const std::int64_t any = -1;
  const Status read = sql_->rows(
      "SELECT time, kind, about, value, detail, number FROM history WHERE node = ? AND sensor = ? AND time >= ? AND "
      "time <= ? AND (time, number) < (?, ?) AND (? = -1 OR kind = ?) ORDER BY time DESC, number DESC LIMIT ?",
      [&](const SqlRow& row) -> Status {
        if (out.entries.size() == query.most) {
          out.next = last;
          return Done{};
        }
        const std::int64_t kind = row.integer(1);
        if (kind < 0 || kind >= static_cast<std::int64_t>(enum_names(HistoryKind{}).size()))
          return sql_->damaged("kind " + std::to_string(kind));
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

}  // namespace trb::gateway
