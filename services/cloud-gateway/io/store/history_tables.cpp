#include "services/cloud-gateway/io/store/history_tables.hpp"

#include <algorithm>
#include <array>

#include "services/cloud-gateway/io/store/in_order.hpp"

namespace trb::gateway {
namespace {

constexpr std::size_t kManyRows = 64;
constexpr std::size_t kSomeRows = 8;
constexpr std::size_t kReadAtOnce = 1000;
constexpr std::int64_t kCountAtOnce = 200'000;  ///< a server gives a statement 3 s
constexpr int kRecount = 1000;                  ///< removals, and what other gateways have written is counted too

/// As much as it takes as text: its time, and what stands between.
std::size_t size_of(const HistoryEntry& entry) {
  return 32 + entry.about.size() + entry.value.size() + entry.detail.size();
}

std::int64_t size_on_disk(const HistoryEntry& entry) {
  return static_cast<std::int64_t>(144 + 2 * (entry.node.size() + entry.sensor.size()) + entry.about.size() +
                                   entry.value.size() + entry.detail.size());
}

std::string insert_of(std::size_t rows) {
  std::string out = "INSERT INTO history(time, node, sensor, kind, about, value, detail) VALUES";
  for (std::size_t i = 0; i < rows; ++i) out += i == 0 ? "(?,?,?,?,?,?,?)" : ",(?,?,?,?,?,?,?)";
  return out;
}

}  // namespace

Status HistoryTables::add(const std::vector<HistoryEntry>& entries, UtcTime now) {
  const Status done = sql_->transact([&]() -> Status {
    const auto mine = own(entries);
    if (!mine) return mine.error();
    return in_order([&] { return insert(*mine); }, [&] { return remove_old(now); }, [&] { return remove_excess(); });
  });
  if (!done) sizes_.reset();  // nothing of it was written
  return done;
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
  for (const HistoryEntry& one : entries) {
    if (sizes_) sizes_->add({one.node, one.sensor}, size_on_disk(one));
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
    const SqlValue value = last;
    if (Status done = remove("number <= ?", {&value, 1}, count); !done) return done;
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

/// Of whoever has more than its share, else the oldest of all.
Status HistoryTables::remove_excess() {
  for (int i = 0; i < kMaxSteps; ++i) {
    std::uint64_t bytes = 0;
    if (Status read = used(bytes); !read || bytes <= limits_.bytes) return read;
    if (++removals_ > kRecount) sizes_.reset();
    if (!sizes_) {
      if (Status counted = count_sizes(); !counted) return counted;
    }
    std::int64_t count = 0;
    if (const auto stream = sizes_->over_share()) {
      if (Status done = remove_of(*stream, count); !done) return done;
      if (count == 0) sizes_->forget(*stream);
      continue;
    }
    const SqlValue value = kStep;
    const Status done = remove("number < (SELECT min(number) + ? FROM history)", {&value, 1}, count);
    if (!done || count == 0) return done;
  }
  return Done{};
}

Status HistoryTables::remove_of(const HistoryStream& stream, std::int64_t& count) {
  const std::array<SqlValue, 3> values{std::string_view(stream.node), std::string_view(stream.sensor), kStep};
  return remove("number IN (SELECT number FROM history WHERE node = ? AND sensor = ? ORDER BY time, number LIMIT ?)",
                values, count);
}

Status HistoryTables::remove(const std::string& which, std::span<const SqlValue> values, std::int64_t& count) {
  count = 0;
  const std::string all = "DELETE FROM history WHERE " + which + " RETURNING node, sensor, " + size_column();
  return sql_->rows_with(
      all.c_str(),
      [&](const SqlRow& row) -> Status {
        ++count;
        if (sizes_) sizes_->remove({row.text(0), row.text(1)}, row.integer(2));
        return Done{};
      },
      values);
}

/// Once after a start, if there is too much.
Status HistoryTables::count_sizes() {
  HistorySizes sizes;
  removals_ = 0;
  std::int64_t first = 0;
  std::int64_t last = 0;
  const Status read = in_order([&] { return number_of("SELECT coalesce(min(number), 0) FROM history", first); },
                               [&] { return number_of("SELECT coalesce(max(number), 0) FROM history", last); });
  if (!read) return read;
  const std::string query = "SELECT node, sensor, CAST(sum(" + size_column() +
                            ") AS BIGINT) FROM history WHERE number >= ? AND number < ? GROUP BY node, sensor";
  for (std::int64_t at = first; at <= last; at += kCountAtOnce) {
    const Status counted = sql_->rows(
        query.c_str(),
        [&](const SqlRow& row) -> Status {
          sizes.add({row.text(0), row.text(1)}, row.integer(2));
          return Done{};
        },
        at, at + kCountAtOnce);
    if (!counted) return counted;
  }
  sizes_ = std::move(sizes);
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
