#include "services/cloud-gateway/io/store/store_rows.hpp"

#include <limits>

#include "proto/bodies/run.hpp"
#include "services/cloud-gateway/io/store/in_order.hpp"

namespace trb::gateway {
namespace {

constexpr const char* kSteady = "steady";
constexpr const char* kRestored = "restored";  ///< `trb node restore` writes it

Status put_row(Sql& sql, const User& user) {
  return sql.run(
      "INSERT INTO users(name, role, password_hash, disabled, since, stamp, must_change) VALUES(?,?,?,?,?,?,?) "
      "ON CONFLICT(name) DO UPDATE SET role = excluded.role, password_hash = excluded.password_hash, "
      "disabled = excluded.disabled, since = excluded.since, stamp = excluded.stamp, "
      "must_change = excluded.must_change",
      user.name, static_cast<std::uint32_t>(user.role), user.password_hash, user.disabled, user.since.ns,
      BlobView{user.stamp}, user.must_change);
}

Status put_row(Sql& sql, const Session& session) {
  return sql.run(
      "INSERT INTO sessions(key, \"user\", stamp, made, used) VALUES(?,?,?,?,?) "
      "ON CONFLICT(key) DO UPDATE SET \"user\" = excluded.\"user\", stamp = excluded.stamp, made = excluded.made, "
      "used = excluded.used",
      BlobView{session.key}, session.user, BlobView{session.stamp}, session.made.ns, session.used.ns);
}

Status put_row(Sql& sql, const Token& token) {
  return sql.run(
      "INSERT INTO tokens(name, role, read_only, made_by, made, ends, key) VALUES(?,?,?,?,?,?,?) "
      "ON CONFLICT(name) DO UPDATE SET role = excluded.role, read_only = excluded.read_only, "
      "made_by = excluded.made_by, made = excluded.made, ends = excluded.ends, key = excluded.key",
      token.name, static_cast<std::uint32_t>(token.role), token.read_only, token.made_by, token.made.ns, token.ends.ns,
      BlobView{token.key});
}

/// An intent is answered once, and never comes in the place of another one.
Status put_row(Sql& sql, const StoredRequest& request) {
  std::optional<std::uint32_t> status;
  std::optional<BlobView> body;
  if (request.answer) {
    status = request.answer->status;
    body = BlobView{request.answer->body};
  }
  const Status done = sql.run(
      "INSERT INTO requests(\"user\", key, digest, effect, since, status, body) VALUES(?,?,?,?,?,?,?) "
      "ON CONFLICT(\"user\", key) DO UPDATE SET digest = excluded.digest, effect = excluded.effect, "
      "since = excluded.since, status = excluded.status, body = excluded.body "
      "WHERE requests.status IS NULL AND excluded.status IS NOT NULL",
      request.key.user, request.key.key, BlobView{request.digest}, request.effect, request.since.ns, status, body);
  if (!done || sql.changed() > 0) return done;
  return fail(Errc::conflict, sql.name() + ": a request with this Idempotency-Key is there already",
              "another gateway has received it: repeat it with the same key");
}

Status put_row(Sql& sql, const StoredScenario& scenario) {
  return sql.run(
      "INSERT INTO scenarios(id, text, name, tasks, version, who, changed) VALUES(?,?,?,?,?,?,?) "
      "ON CONFLICT(id) DO UPDATE SET text = excluded.text, name = excluded.name, tasks = excluded.tasks, "
      "version = excluded.version, who = excluded.who, changed = excluded.changed",
      scenario.id, scenario.scenario.text, scenario.scenario.name, scenario.scenario.tasks,
      static_cast<std::int64_t>(scenario.version), scenario.by, scenario.changed.ns);
}

Status put_row(Sql& sql, const Acknowledgement& one) {
  return sql.run(
      "INSERT INTO acknowledged(alert, who, time, severity) VALUES(?,?,?,?) "
      "ON CONFLICT(alert) DO UPDATE SET who = excluded.who, time = excluded.time, severity = excluded.severity",
      one.alert, one.by, one.at.ns, static_cast<std::uint32_t>(one.severity));
}

Status put_row(Sql& sql, const Shelf& one) {
  return sql.run(
      "INSERT INTO shelves(source, who, time, ends, why) VALUES(?,?,?,?,?) "
      "ON CONFLICT(source) DO UPDATE SET who = excluded.who, time = excluded.time, ends = excluded.ends, "
      "why = excluded.why",
      one.source, one.by, one.at.ns, one.until.ns, one.why);
}

/// `drop`: DELETE of the row with this key.
template <class Row, class Key>
Status write_changes(Sql& sql, const std::vector<Change<Row>>& changes, const char* drop, const Key& as_key) {
  for (const Change<Row>& change : changes) {
    const Status done = change.row ? put_row(sql, *change.row) : sql.run(drop, as_key(change.key));
    if (!done) return done;
  }
  return Done{};
}

std::string_view text_key(const std::string& key) {
  return key;
}

BlobView blob_key(const std::string& key) {
  return {key};
}

Result<std::int64_t> enabled_admins(Sql& sql) {
  std::int64_t out = 0;
  const Status read = sql.rows(
      "SELECT count(*) FROM users WHERE role = ? AND disabled = 0",
      [&](const SqlRow& row) -> Status {
        out = row.integer(0);
        return Done{};
      },
      static_cast<std::uint32_t>(UserRole::admin));
  if (!read) return read.error();
  return out;
}

Status write_users(Sql& sql, const std::vector<Change<User>>& users) {
  if (users.empty()) return Done{};
  const auto before = enabled_admins(sql);
  if (!before) return before.error();
  const Status done = write_changes(sql, users, "DELETE FROM users WHERE name = ?", text_key);
  if (!done) return done;
  const auto after = enabled_admins(sql);
  if (!after) return after.error();
  if (*before == 0 || *after > 0) return Done{};
  return fail(Errc::conflict, sql.name() + ": no enabled admin would be left",
              "make another user an admin first; another gateway may have changed the users");
}

Status write_requests(Sql& sql, const StoreBatch& batch) {
  for (const RequestKey& key : batch.dropped_requests) {
    const Status done = sql.run("DELETE FROM requests WHERE \"user\" = ? AND key = ?", key.user, key.key);
    if (!done) return done;
  }
  for (const StoredRequest& request : batch.requests) {
    if (Status done = put_row(sql, request); !done) return done;
  }
  for (const MovedRequest& moved : batch.moved_requests) {
    const Status done = sql.run("UPDATE requests SET since = ? WHERE \"user\" = ? AND key = ?", moved.since.ns,
                                moved.key.user, moved.key.key);
    if (!done) return done;
  }
  return Done{};
}

Status write_steady(Sql& sql, const std::optional<UtcTime>& steady) {
  if (!steady) return Done{};
  return sql.run("INSERT INTO meta(name, value) VALUES(?,?) ON CONFLICT(name) DO UPDATE SET value = excluded.value",
                 kSteady, steady->ns);
}

Result<UserRole> role_in(const Sql& sql, std::int64_t role, const std::string& whose) {
  if (role >= 0 && role <= static_cast<std::int64_t>(UserRole::admin)) return static_cast<UserRole>(role);
  return sql.damaged("role " + std::to_string(role) + " of '" + whose + "'");
}

Status read_users(Sql& sql, std::vector<User>& out) {
  return sql.rows(
      "SELECT name, role, password_hash, disabled, since, stamp, must_change FROM users ORDER BY name",
      [&](const SqlRow& row) -> Status {
        const auto role = role_in(sql, row.integer(1), row.text(0));
        if (!role) return role.error();
        out.push_back(
            {row.text(0), *role, row.text(2), row.integer(3) != 0, {row.integer(4)}, row.text(5), row.integer(6) != 0});
        return Done{};
      });
}

Status read_sessions(Sql& sql, std::vector<Session>& out) {
  return sql.rows("SELECT key, \"user\", stamp, made, used FROM sessions ORDER BY key",
                  [&](const SqlRow& row) -> Status {
                    out.push_back({row.text(0), row.text(1), row.text(2), {row.integer(3)}, {row.integer(4)}});
                    return Done{};
                  });
}

Status read_tokens(Sql& sql, std::vector<Token>& out) {
  return sql.rows(
      "SELECT name, role, read_only, made_by, made, ends, key FROM tokens ORDER BY name",
      [&](const SqlRow& row) -> Status {
        const auto role = role_in(sql, row.integer(1), row.text(0));
        if (!role) return role.error();
        out.push_back(
            {row.text(0), *role, row.integer(2) != 0, row.text(3), {row.integer(4)}, {row.integer(5)}, row.text(6)});
        return Done{};
      });
}

Result<std::optional<StoredAnswer>> answer_in(const Sql& sql, const SqlRow& row) {
  if (row.is_null(5)) return std::optional<StoredAnswer>();
  const std::int64_t status = row.integer(5);
  if (status < 0 || status > std::numeric_limits<std::uint16_t>::max()) {
    return sql.damaged("status " + std::to_string(status) + " of a request of '" + row.text(0) + "'");
  }
  return std::optional(StoredAnswer{static_cast<std::uint16_t>(status), row.text(6)});
}

Status read_requests(Sql& sql, std::vector<StoredRequest>& out) {
  return sql.rows(
      "SELECT \"user\", key, digest, effect, since, status, body FROM requests ORDER BY \"user\", key",
      [&](const SqlRow& row) -> Status {
        auto answer = answer_in(sql, row);
        if (!answer) return answer.error();
        out.push_back({{row.text(0), row.text(1)}, row.text(2), row.text(3), {row.integer(4)}, std::move(*answer)});
        return Done{};
      });
}

Status read_scenarios(Sql& sql, std::vector<StoredScenario>& out) {
  return sql.rows(
      "SELECT id, text, name, tasks, version, who, changed FROM scenarios ORDER BY id",
      [&](const SqlRow& row) -> Status {
        if (row.integer(3) < 0 || row.integer(3) > kMaxTasks || row.integer(4) < 1) {
          return sql.damaged("scenario '" + row.text(0) + "'");
        }
        ScenarioText text{row.text(1), row.text(2), static_cast<std::uint32_t>(row.integer(3))};
        out.push_back(
            {row.text(0), std::move(text), static_cast<std::uint64_t>(row.integer(4)), row.text(5), {row.integer(6)}});
        return Done{};
      });
}

Status read_acknowledged(Sql& sql, std::vector<Acknowledgement>& out) {
  return sql.rows(
      "SELECT alert, who, time, severity FROM acknowledged ORDER BY alert", [&](const SqlRow& row) -> Status {
        if (row.integer(3) < 0 || row.integer(3) >= static_cast<std::int64_t>(enum_names(Severity{}).size())) {
          return sql.damaged("acknowledgement of '" + row.text(0) + "'");
        }
        out.push_back({row.text(0), row.text(1), {row.integer(2)}, static_cast<Severity>(row.integer(3))});
        return Done{};
      });
}

Status read_shelves(Sql& sql, std::vector<Shelf>& out) {
  return sql.rows("SELECT source, who, time, ends, why FROM shelves ORDER BY source", [&](const SqlRow& row) -> Status {
    out.push_back({row.text(0), row.text(1), {row.integer(2)}, {row.integer(3)}, row.text(4)});
    return Done{};
  });
}

Status read_time(Sql& sql, const char* name, std::optional<UtcTime>& out) {
  return sql.rows(
      "SELECT value FROM meta WHERE name = ?",
      [&](const SqlRow& row) -> Status {
        out = UtcTime{row.integer(0)};
        return Done{};
      },
      name);
}

}  // namespace

Status write_state(Sql& sql, const StoreBatch& batch) {
  return in_order(
      [&] { return write_users(sql, batch.users); },
      [&] { return write_changes(sql, batch.sessions, "DELETE FROM sessions WHERE key = ?", blob_key); },
      [&] { return write_changes(sql, batch.tokens, "DELETE FROM tokens WHERE name = ?", text_key); },
      [&] { return write_requests(sql, batch); },
      [&] { return write_changes(sql, batch.scenarios, "DELETE FROM scenarios WHERE id = ?", text_key); },
      [&] { return write_changes(sql, batch.acknowledged, "DELETE FROM acknowledged WHERE alert = ?", text_key); },
      [&] { return write_changes(sql, batch.shelves, "DELETE FROM shelves WHERE source = ?", text_key); },
      [&] { return write_steady(sql, batch.steady); },
      [&] { return batch.notes_restored ? sql.run("DELETE FROM meta WHERE name = ?", kRestored) : Status(Done{}); });
}

Status read_state(Sql& sql, const StoreKinds& kinds, StoredState& out) {
  const auto read = [&](StoreKind kind, auto rows, auto& into) {
    return kinds.contains(kind) ? rows(sql, into) : Status(Done{});
  };
  return in_order([&] { return read(StoreKind::users, read_users, out.users); },
                  [&] { return read(StoreKind::sessions, read_sessions, out.sessions); },
                  [&] { return read(StoreKind::tokens, read_tokens, out.tokens); },
                  [&] { return read(StoreKind::requests, read_requests, out.requests); },
                  [&] { return read(StoreKind::scenarios, read_scenarios, out.scenarios); },
                  [&] { return read(StoreKind::acknowledged, read_acknowledged, out.acknowledged); },
                  [&] { return read(StoreKind::shelves, read_shelves, out.shelves); },
                  [&] { return read_time(sql, kSteady, out.steady); },
                  [&] { return read_time(sql, kRestored, out.restored); });
}

}  // namespace trb::gateway
