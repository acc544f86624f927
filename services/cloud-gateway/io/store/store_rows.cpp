#include "services/cloud-gateway/io/store/store_rows.hpp"

#include <limits>

#include "proto/bodies/run.hpp"
#include "services/cloud-gateway/io/store/in_order.hpp"

namespace trb::gateway {
namespace {

constexpr const char* kSteady = "steady";

Status put_row(SqliteFile& file, const User& user) {
  return file.run("INSERT OR REPLACE INTO users(name, role, password_hash, disabled, since, stamp) VALUES(?,?,?,?,?,?)",
                  user.name, static_cast<std::uint32_t>(user.role), user.password_hash, user.disabled, user.since.ns,
                  BlobView{user.stamp});
}

Status put_row(SqliteFile& file, const Session& session) {
  return file.run("INSERT OR REPLACE INTO sessions(key, user, stamp, made, used) VALUES(?,?,?,?,?)",
                  BlobView{session.key}, session.user, BlobView{session.stamp}, session.made.ns, session.used.ns);
}

Status put_row(SqliteFile& file, const Token& token) {
  return file.run(
      "INSERT OR REPLACE INTO tokens(name, role, read_only, made_by, made, ends, key) VALUES(?,?,?,?,?,?,?)",
      token.name, static_cast<std::uint32_t>(token.role), token.read_only, token.made_by, token.made.ns, token.ends.ns,
      BlobView{token.key});
}

Status put_row(SqliteFile& file, const StoredRequest& request) {
  std::optional<std::uint32_t> status;
  std::optional<BlobView> body;
  if (request.answer) {
    status = request.answer->status;
    body = BlobView{request.answer->body};
  }
  return file.run(
      "INSERT OR REPLACE INTO requests(user, key, digest, effect, since, status, body) VALUES(?,?,?,?,?,?,?)",
      request.key.user, request.key.key, BlobView{request.digest}, request.effect, request.since.ns, status, body);
}

Status put_row(SqliteFile& file, const StoredScenario& scenario) {
  return file.run(
      "INSERT OR REPLACE INTO scenarios(id, text, name, tasks, version, who, changed) VALUES(?,?,?,?,?,?,?)",
      scenario.id, scenario.scenario.text, scenario.scenario.name, scenario.scenario.tasks,
      static_cast<std::int64_t>(scenario.version), scenario.by, scenario.changed.ns);
}

/// `drop`: DELETE of the row with this key.
template <class Row, class Key>
Status write_changes(SqliteFile& file, const std::vector<Change<Row>>& changes, const char* drop, const Key& as_key) {
  for (const Change<Row>& change : changes) {
    const Status done = change.row ? put_row(file, *change.row) : file.run(drop, as_key(change.key));
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

Result<std::int64_t> enabled_admins(SqliteFile& file) {
  std::int64_t out = 0;
  const Status read = file.rows(
      "SELECT count(*) FROM users WHERE role = ? AND disabled = 0",
      [&](const Columns& row) -> Status {
        out = row.integer(0);
        return Done{};
      },
      static_cast<std::uint32_t>(UserRole::admin));
  if (!read) return read.error();
  return out;
}

Status write_users(SqliteFile& file, const std::vector<Change<User>>& users) {
  if (users.empty()) return Done{};
  const auto before = enabled_admins(file);
  if (!before) return before.error();
  const Status done = write_changes(file, users, "DELETE FROM users WHERE name = ?", text_key);
  if (!done) return done;
  const auto after = enabled_admins(file);
  if (!after) return after.error();
  if (*before == 0 || *after > 0) return Done{};
  return fail(Errc::conflict, file.path() + ": no enabled admin would be left",
              "make another user an admin first; another gateway may have changed the users");
}

Status write_requests(SqliteFile& file, const StoreBatch& batch) {
  for (const RequestKey& key : batch.dropped_requests) {
    const Status done = file.run("DELETE FROM requests WHERE user = ? AND key = ?", key.user, key.key);
    if (!done) return done;
  }
  for (const StoredRequest& request : batch.requests) {
    if (Status done = put_row(file, request); !done) return done;
  }
  return Done{};
}

Status write_steady(SqliteFile& file, const std::optional<UtcTime>& steady) {
  if (!steady) return Done{};
  return file.run("INSERT OR REPLACE INTO meta(name, value) VALUES(?,?)", kSteady, steady->ns);
}

Result<UserRole> role_in(const SqliteFile& file, std::int64_t role, const std::string& whose) {
  if (role >= 0 && role <= static_cast<std::int64_t>(UserRole::admin)) return static_cast<UserRole>(role);
  return file.damaged("role " + std::to_string(role) + " of '" + whose + "'");
}

Status read_users(SqliteFile& file, std::vector<User>& out) {
  return file.rows(
      "SELECT name, role, password_hash, disabled, since, stamp FROM users ORDER BY name",
      [&](const Columns& row) -> Status {
        const auto role = role_in(file, row.integer(1), row.text(0));
        if (!role) return role.error();
        out.push_back({row.text(0), *role, row.text(2), row.integer(3) != 0, {row.integer(4)}, row.text(5)});
        return Done{};
      });
}

Status read_sessions(SqliteFile& file, std::vector<Session>& out) {
  return file.rows("SELECT key, user, stamp, made, used FROM sessions ORDER BY key", [&](const Columns& row) -> Status {
    out.push_back({row.text(0), row.text(1), row.text(2), {row.integer(3)}, {row.integer(4)}});
    return Done{};
  });
}

Status read_tokens(SqliteFile& file, std::vector<Token>& out) {
  return file.rows(
      "SELECT name, role, read_only, made_by, made, ends, key FROM tokens ORDER BY name",
      [&](const Columns& row) -> Status {
        const auto role = role_in(file, row.integer(1), row.text(0));
        if (!role) return role.error();
        out.push_back(
            {row.text(0), *role, row.integer(2) != 0, row.text(3), {row.integer(4)}, {row.integer(5)}, row.text(6)});
        return Done{};
      });
}

Result<std::optional<StoredAnswer>> answer_in(const SqliteFile& file, const Columns& row) {
  if (row.is_null(5)) return std::optional<StoredAnswer>();
  const std::int64_t status = row.integer(5);
  if (status < 0 || status > std::numeric_limits<std::uint16_t>::max()) {
    return file.damaged("status " + std::to_string(status) + " of a request of '" + row.text(0) + "'");
  }
  return std::optional(StoredAnswer{static_cast<std::uint16_t>(status), row.text(6)});
}

Status read_requests(SqliteFile& file, std::vector<StoredRequest>& out) {
  return file.rows(
      "SELECT user, key, digest, effect, since, status, body FROM requests ORDER BY user, key",
      [&](const Columns& row) -> Status {
        auto answer = answer_in(file, row);
        if (!answer) return answer.error();
        out.push_back({{row.text(0), row.text(1)}, row.text(2), row.text(3), {row.integer(4)}, std::move(*answer)});
        return Done{};
      });
}

Status read_scenarios(SqliteFile& file, std::vector<StoredScenario>& out) {
  return file.rows(
      "SELECT id, text, name, tasks, version, who, changed FROM scenarios ORDER BY id",
      [&](const Columns& row) -> Status {
        if (row.integer(3) < 0 || row.integer(3) > kMaxTasks || row.integer(4) < 1) {
          return file.damaged("scenario '" + row.text(0) + "'");
        }
        ScenarioText text{row.text(1), row.text(2), static_cast<std::uint32_t>(row.integer(3))};
        out.push_back(
            {row.text(0), std::move(text), static_cast<std::uint64_t>(row.integer(4)), row.text(5), {row.integer(6)}});
        return Done{};
      });
}

Status read_steady(SqliteFile& file, std::optional<UtcTime>& out) {
  return file.rows(
      "SELECT value FROM meta WHERE name = ?",
      [&](const Columns& row) -> Status {
        out = UtcTime{row.integer(0)};
        return Done{};
      },
      kSteady);
}

}  // namespace

Status write_state(SqliteFile& file, const StoreBatch& batch) {
  return in_order([&] { return write_users(file, batch.users); },
                  [&] { return write_changes(file, batch.sessions, "DELETE FROM sessions WHERE key = ?", blob_key); },
                  [&] { return write_changes(file, batch.tokens, "DELETE FROM tokens WHERE name = ?", text_key); },
                  [&] { return write_requests(file, batch); },
                  [&] { return write_changes(file, batch.scenarios, "DELETE FROM scenarios WHERE id = ?", text_key); },
                  [&] { return write_steady(file, batch.steady); });
}

Status read_state(SqliteFile& file, StoredState& out) {
  return in_order([&] { return read_users(file, out.users); }, [&] { return read_sessions(file, out.sessions); },
                  [&] { return read_tokens(file, out.tokens); }, [&] { return read_requests(file, out.requests); },
                  [&] { return read_scenarios(file, out.scenarios); }, [&] { return read_steady(file, out.steady); });
}

}  // namespace trb::gateway
