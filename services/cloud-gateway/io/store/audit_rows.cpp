#include "services/cloud-gateway/io/store/audit_rows.hpp"

#include <algorithm>
#include <limits>

#include "services/cloud-gateway/io/store/in_order.hpp"

namespace trb::gateway {
namespace {

constexpr std::size_t kMostAudit = 1000;

/// SQLite's integers have a sign; no record has a number above the highest one.
std::int64_t as_integer(std::uint64_t number) {
  constexpr auto kHighest = static_cast<std::uint64_t>(std::numeric_limits<std::int64_t>::max());
  return static_cast<std::int64_t>(std::min(number, kHighest));
}

Status append_row(Sql& sql, const AuditRow& row) {
  const AuditRecord& is = row.record;
  const Status done =
      sql.run("INSERT INTO audit(number, time, who, address, action, about, outcome, hash) VALUES(?,?,?,?,?,?,?,?)",
              as_integer(is.number), is.time, is.who, is.from, is.action, is.about, is.outcome, BlobView{row.hash});
  if (done || done.error().code != Errc::conflict) return done;
  return fail(Errc::conflict,
              sql.name() + ": audit record " + std::to_string(is.number) + " does not follow the last stored one",
              "another gateway uses this store: end one of the two, and start the other again");
}

Status append_head(Sql& sql, const SignedHead& head) {
  return sql.run("INSERT INTO heads(number, record) VALUES(?,?) ON CONFLICT(number) DO NOTHING",
                 as_integer(head.number), BlobView{head.record});
}

AuditRow audit_row(const SqlRow& row) {
  return {{static_cast<std::uint64_t>(row.integer(0)), row.integer(1), row.text(2), row.text(3), row.text(4),
           row.text(5), row.text(6)},
          row.text(7)};
}

/// `which`: what follows "FROM audit".
template <class... Values>
Result<std::vector<AuditRow>> audit_rows(Sql& sql, std::string_view which, const Values&... values) {
  std::string text = "SELECT number, time, who, address, action, about, outcome, hash FROM audit ";
  text += which;
  std::vector<AuditRow> out;
  const auto take = [&](const SqlRow& row) -> Status {
    out.push_back(audit_row(row));
    return Done{};
  };
  if (Status done = sql.rows(text.c_str(), take, values...); !done) return done.error();
  return out;
}

Status read_last(Sql& sql, std::optional<AuditRow>& out) {
  auto rows = audit_rows(sql, "ORDER BY number DESC LIMIT 1");
  if (!rows) return rows.error();
  if (!rows->empty()) out = std::move(rows->front());
  return Done{};
}

Status read_signed_to(Sql& sql, std::uint64_t& out) {
  return sql.rows("SELECT coalesce(max(number), 0) FROM heads", [&](const SqlRow& row) -> Status {
    out = static_cast<std::uint64_t>(row.integer(0));
    return Done{};
  });
}

}  // namespace

Status write_audit(Sql& sql, const StoreBatch& batch) {
  for (const AuditRow& row : batch.audit) {
    if (Status done = append_row(sql, row); !done) return done;
  }
  for (const SignedHead& head : batch.heads) {
    if (Status done = append_head(sql, head); !done) return done;
  }
  return Done{};
}

Result<std::vector<AuditRow>> read_audit(Sql& sql, const AuditQuery& query) {
  if (query.most < 1 || query.most > kMostAudit) {
    return fail(Errc::bad_value, "most: " + std::to_string(query.most), "use a number from 1 to 1000");
  }
  const std::int64_t before = as_integer(query.before.value_or(std::numeric_limits<std::uint64_t>::max()));
  const std::int64_t most = as_integer(query.most);
  if (query.who.empty()) return audit_rows(sql, "WHERE number < ? ORDER BY number DESC LIMIT ?", before, most);
  return audit_rows(sql, "WHERE who = ? AND number < ? ORDER BY number DESC LIMIT ?", query.who, before, most);
}

Result<std::vector<AuditRow>> read_audit_from(Sql& sql, std::uint64_t number, std::size_t most) {
  return audit_rows(sql, "WHERE number >= ? ORDER BY number LIMIT ?", as_integer(number), as_integer(most));
}

Result<std::vector<SignedHead>> read_heads(Sql& sql, std::uint64_t first, std::uint64_t last) {
  std::vector<SignedHead> out;
  const auto take = [&](const SqlRow& row) -> Status {
    out.push_back({static_cast<std::uint64_t>(row.integer(0)), row.text(1)});
    return Done{};
  };
  const Status done = sql.rows("SELECT number, record FROM heads WHERE number BETWEEN ? AND ? ORDER BY number", take,
                               as_integer(first), as_integer(last));
  if (!done) return done.error();
  return out;
}

Status read_end(Sql& sql, StoredState& out) {
  return in_order([&] { return read_last(sql, out.last_audit); }, [&] { return read_signed_to(sql, out.signed_to); });
}

}  // namespace trb::gateway
