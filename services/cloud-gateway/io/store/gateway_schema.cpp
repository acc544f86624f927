#include "services/cloud-gateway/io/store/gateway_schema.hpp"

#include <array>

#include "common/sqlite/migrate.hpp"

namespace trb::gateway {
namespace {

// Never changed once released: a change is a further step. Times are UTC ns. The triggers stop mistakes, also of the
// one who repairs by hand; who may write the file can drop them, and is revealed by the signed heads.
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
};

}  // namespace

Status migrate_gateway(SqliteFile& file) {
  return migrate(file, kGatewaySteps,
                 "start the build that wrote it; without it users, tokens and the audit log are lost, so keep a copy");
}

}  // namespace trb::gateway
