#include "services/cloud-gateway/io/store/gateway_schema.hpp"

#include <array>

namespace trb::gateway {
namespace {

// Never changed once released: a change is a further step, in both databases. Times are UTC ns. The triggers stop
// mistakes, also of the one who repairs by hand; who may write the file can drop them, and is revealed by the signed
// heads.
constexpr std::array kGatewaySteps{
    R"(
CREATE TABLE users(
  name TEXT PRIMARY KEY, role INTEGER NOT NULL, password_hash TEXT NOT NULL, disabled INTEGER NOT NULL,
  since INTEGER NOT NULL, stamp BLOB NOT NULL) STRICT, WITHOUT ROWID;
CREATE TABLE sessions(
  key BLOB PRIMARY KEY, user TEXT NOT NULL, stamp BLOB NOT NULL, made INTEGER NOT NULL, used INTEGER NOT NULL)
  STRICT, WITHOUT ROWID;
CREATE TABLE tokens(
  name TEXT PRIMARY KEY, role INTEGER NOT NULL, read_only INTEGER NOT NULL, made_by TEXT NOT NULL,
  made INTEGER NOT NULL, ends INTEGER NOT NULL, key BLOB NOT NULL) STRICT, WITHOUT ROWID;
CREATE TABLE requests(
  user TEXT NOT NULL, key TEXT NOT NULL, digest BLOB NOT NULL, effect TEXT NOT NULL, since INTEGER NOT NULL,
  status INTEGER, body BLOB, PRIMARY KEY(user, key)) STRICT, WITHOUT ROWID;
CREATE TABLE audit(
  number INTEGER PRIMARY KEY, time INTEGER NOT NULL, who TEXT NOT NULL, address TEXT NOT NULL, action TEXT NOT NULL,
  about TEXT NOT NULL, outcome TEXT NOT NULL, hash BLOB NOT NULL) STRICT;
CREATE INDEX audit_of_who ON audit(who, number);
CREATE TABLE heads(number INTEGER PRIMARY KEY, record BLOB NOT NULL) STRICT;
CREATE TABLE meta(name TEXT PRIMARY KEY, value INTEGER NOT NULL) STRICT, WITHOUT ROWID;
CREATE TRIGGER audit_follows BEFORE INSERT ON audit
  WHEN new.number IS NOT (SELECT coalesce(max(number), 0) + 1 FROM audit)
  BEGIN SELECT raise(ABORT, 'the audit record does not follow the last one'); END;
CREATE TRIGGER audit_stays BEFORE UPDATE ON audit BEGIN SELECT raise(ABORT, 'audit records are never changed'); END;
CREATE TRIGGER audit_kept BEFORE DELETE ON audit BEGIN SELECT raise(ABORT, 'audit records are never removed'); END;
CREATE TRIGGER head_once BEFORE INSERT ON heads WHEN EXISTS(SELECT 1 FROM heads WHERE number = new.number)
  BEGIN SELECT raise(IGNORE); END;
CREATE TRIGGER head_stays BEFORE UPDATE ON heads BEGIN SELECT raise(ABORT, 'signed heads are never changed'); END;
CREATE TRIGGER head_kept BEFORE DELETE ON heads BEGIN SELECT raise(ABORT, 'signed heads are never removed'); END;
)",
    R"(
CREATE TABLE scenarios(
  id TEXT PRIMARY KEY, text TEXT NOT NULL, name TEXT NOT NULL, tasks INTEGER NOT NULL, version INTEGER NOT NULL,
  who TEXT NOT NULL, changed INTEGER NOT NULL) STRICT;
)",
    R"(
CREATE TABLE acknowledged(
  alert TEXT PRIMARY KEY, who TEXT NOT NULL, time INTEGER NOT NULL, severity INTEGER NOT NULL) STRICT, WITHOUT ROWID;
CREATE TABLE shelves(
  source TEXT PRIMARY KEY, who TEXT NOT NULL, time INTEGER NOT NULL, ends INTEGER NOT NULL, why TEXT NOT NULL)
  STRICT, WITHOUT ROWID;
ALTER TABLE users ADD COLUMN must_change INTEGER NOT NULL DEFAULT 0;
)",
    R"(
DROP TRIGGER audit_follows;
CREATE TRIGGER audit_follows BEFORE INSERT ON audit
  WHEN new.number IS NOT max((SELECT coalesce(max(number), 0) + 1 FROM audit),
                             iif(new.action = 'restored', new.time / 1000000, 0))
  BEGIN SELECT raise(ABORT, 'the audit record does not follow the last one'); END;
)",
};

// The same tables for PostgreSQL. A table that a gateway keeps in memory has a row in `versions`, which each change of
// the table raises: so the others learn of it.
constexpr std::array kPostgresSteps{
    R"(
CREATE TABLE users(
  name BYTEA PRIMARY KEY, role BIGINT NOT NULL, password_hash BYTEA NOT NULL, disabled BIGINT NOT NULL,
  since BIGINT NOT NULL, stamp BYTEA NOT NULL);
CREATE TABLE sessions(
  key BYTEA PRIMARY KEY, "user" BYTEA NOT NULL, stamp BYTEA NOT NULL, made BIGINT NOT NULL, used BIGINT NOT NULL);
CREATE TABLE tokens(
  name BYTEA PRIMARY KEY, role BIGINT NOT NULL, read_only BIGINT NOT NULL, made_by BYTEA NOT NULL,
  made BIGINT NOT NULL, ends BIGINT NOT NULL, key BYTEA NOT NULL);
CREATE TABLE requests(
  "user" BYTEA NOT NULL, key BYTEA NOT NULL, digest BYTEA NOT NULL, effect BYTEA NOT NULL, since BIGINT NOT NULL,
  status BIGINT, body BYTEA, PRIMARY KEY("user", key));
CREATE TABLE audit(
  number BIGINT PRIMARY KEY, time BIGINT NOT NULL, who BYTEA NOT NULL, address BYTEA NOT NULL, action BYTEA NOT NULL,
  about BYTEA NOT NULL, outcome BYTEA NOT NULL, hash BYTEA NOT NULL);
CREATE INDEX audit_of_who ON audit(who, number);
CREATE TABLE heads(number BIGINT PRIMARY KEY, record BYTEA NOT NULL);
CREATE TABLE meta(name BYTEA PRIMARY KEY, value BIGINT NOT NULL);
CREATE TABLE gateways(node BYTEA PRIMARY KEY, certificate BYTEA NOT NULL);
CREATE TABLE chain(one BIGINT PRIMARY KEY CHECK(one = 1), node BYTEA NOT NULL);
CREATE FUNCTION audit_follows() RETURNS trigger LANGUAGE plpgsql AS $$
  BEGIN
    IF new.number IS DISTINCT FROM (SELECT coalesce(max(number), 0) + 1 FROM talkrobots.audit) THEN
      RAISE EXCEPTION 'the audit record does not follow the last one' USING ERRCODE = 'check_violation';
    END IF;
    RETURN new;
  END $$;
CREATE FUNCTION refuse() RETURNS trigger LANGUAGE plpgsql AS $$
  BEGIN RAISE EXCEPTION '%', tg_argv[0] USING ERRCODE = 'check_violation'; END $$;
CREATE TRIGGER audit_follows BEFORE INSERT ON audit FOR EACH ROW EXECUTE FUNCTION audit_follows();
CREATE TRIGGER audit_stays BEFORE UPDATE ON audit FOR EACH ROW EXECUTE FUNCTION refuse('audit records are never changed');
CREATE TRIGGER audit_kept BEFORE DELETE ON audit FOR EACH ROW EXECUTE FUNCTION refuse('audit records are never removed');
CREATE TRIGGER audit_full BEFORE TRUNCATE ON audit EXECUTE FUNCTION refuse('audit records are never removed');
CREATE TRIGGER head_stays BEFORE UPDATE ON heads FOR EACH ROW EXECUTE FUNCTION refuse('signed heads are never changed');
CREATE TRIGGER head_kept BEFORE DELETE ON heads FOR EACH ROW EXECUTE FUNCTION refuse('signed heads are never removed');
CREATE TRIGGER head_full BEFORE TRUNCATE ON heads EXECUTE FUNCTION refuse('signed heads are never removed');
CREATE TABLE versions(kind TEXT PRIMARY KEY, number BIGINT NOT NULL);
INSERT INTO versions VALUES ('users', 0), ('sessions', 0), ('tokens', 0), ('requests', 0), ('audit', 0);
CREATE FUNCTION raise_version() RETURNS trigger LANGUAGE plpgsql AS $$
  BEGIN
    UPDATE talkrobots.versions SET number = number + 1 WHERE kind = tg_argv[0];
    RETURN NULL;
  END $$;
CREATE TRIGGER users_version AFTER INSERT OR UPDATE OR DELETE OR TRUNCATE ON users
  EXECUTE FUNCTION raise_version('users');
CREATE TRIGGER sessions_version AFTER INSERT OR UPDATE OR DELETE OR TRUNCATE ON sessions
  EXECUTE FUNCTION raise_version('sessions');
CREATE TRIGGER tokens_version AFTER INSERT OR UPDATE OR DELETE OR TRUNCATE ON tokens
  EXECUTE FUNCTION raise_version('tokens');
CREATE TRIGGER requests_version AFTER INSERT OR UPDATE OR DELETE OR TRUNCATE ON requests
  EXECUTE FUNCTION raise_version('requests');
CREATE TRIGGER audit_version AFTER INSERT ON audit EXECUTE FUNCTION raise_version('audit');
CREATE TRIGGER heads_version AFTER INSERT ON heads EXECUTE FUNCTION raise_version('audit');
)",
    R"(
CREATE TABLE scenarios(
  id BYTEA PRIMARY KEY, text BYTEA NOT NULL, name BYTEA NOT NULL, tasks BIGINT NOT NULL, version BIGINT NOT NULL,
  who BYTEA NOT NULL, changed BIGINT NOT NULL);
INSERT INTO versions VALUES ('scenarios', 0);
CREATE TRIGGER scenarios_version AFTER INSERT OR UPDATE OR DELETE OR TRUNCATE ON scenarios
  EXECUTE FUNCTION raise_version('scenarios');
)",
    R"(
CREATE TABLE acknowledged(alert BYTEA PRIMARY KEY, who BYTEA NOT NULL, time BIGINT NOT NULL, severity BIGINT NOT NULL);
CREATE TABLE shelves(
  source BYTEA PRIMARY KEY, who BYTEA NOT NULL, time BIGINT NOT NULL, ends BIGINT NOT NULL, why BYTEA NOT NULL);
ALTER TABLE users ADD COLUMN must_change BIGINT NOT NULL DEFAULT 0;
INSERT INTO versions VALUES ('acknowledged', 0), ('shelves', 0);
CREATE TRIGGER acknowledged_version AFTER INSERT OR UPDATE OR DELETE OR TRUNCATE ON acknowledged
  EXECUTE FUNCTION raise_version('acknowledged');
CREATE TRIGGER shelves_version AFTER INSERT OR UPDATE OR DELETE OR TRUNCATE ON shelves
  EXECUTE FUNCTION raise_version('shelves');
)",
    // A shared store is in no node's backup.
    "SELECT 1;",
};
static_assert(kPostgresSteps.size() == kGatewaySteps.size(), "a step for SQLite is one for PostgreSQL too");

}  // namespace

std::span<const char* const> gateway_steps() {
  return kGatewaySteps;
}

std::span<const char* const> postgres_gateway_steps() {
  return kPostgresSteps;
}

}  // namespace trb::gateway
