#include "services/cloud-gateway/io/store/gateway_db.hpp"

#include <doctest/doctest.h>
#include <sqlite3.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include <csignal>

#include "common/base/test/temporary_folder.hpp"
#include "services/cloud-gateway/core/access/audit_verify.hpp"
#include "services/cloud-gateway/core/access/test/gateway_parts.hpp"

using namespace trb;
using namespace trb::gateway;

namespace {

const Bytes kStart = audit_start(Bytes(16, 'f'), "cloud");

struct StoreBench {
  StoreBench() { open(); }
  void open() {
    db.reset();
    auto opened = GatewayDb::open(path);
    REQUIRE(opened);
    db = std::move(*opened);
  }
  StoredState loaded() {
    auto out = db->load();
    REQUIRE(out);
    return std::move(*out);
  }
  /// The file by SQLite itself, as somebody would who repairs by hand.
  int by_hand(const char* sql) const {
    sqlite3* raw = nullptr;
    REQUIRE(sqlite3_open(path.c_str(), &raw) == SQLITE_OK);
    const int done = sqlite3_exec(raw, sql, nullptr, nullptr, nullptr);
    sqlite3_close(raw);
    return done;
  }

  TemporaryFolder folder;
  std::string path = folder.path + "/gateway.db";
  std::unique_ptr<GatewayDb> db;
  Parts parts;
  AuditChain chain{kStart};
};

AuditRecord done_by(const std::string& who) {
  AuditRecord out;
  out.who = who;
  out.action = "POST /api/v1/stop";
  return out;
}

StoreBatch users_of(Parts& parts) {
  StoreBatch out;
  out.users = parts.users.take_changes();
  return out;
}

}  // namespace

TEST_CASE("store: what was saved is there after a restart, whatever its texts are") {
  StoreBench bench;
  const std::string odd = "'); DROP TABLE users; --\n<script>";
  bench.parts.add("ann", UserRole::admin);
  const std::string session = bench.parts.sign_in("ann");
  REQUIRE(bench.parts.tokens.make(
      {odd.substr(0, 0) + "exporter", UserRole::viewer, true, std::chrono::hours(24), "ann"}, bench.parts.now.utc));
  StoreBatch batch = users_of(bench.parts);
  batch.sessions = bench.parts.sessions.take_changes();
  batch.tokens = bench.parts.tokens.take_changes();
  batch.requests = {{{"ann", odd}, Bytes(32, '\0'), odd, UtcTime{7}, StoredAnswer{201, Bytes("\0x", 2)}},
                    {{"ann", "open"}, Bytes(32, 'd'), "start", UtcTime{8}, std::nullopt}};
  batch.audit = {bench.chain.append(done_by(odd))};
  batch.heads = {{1, Bytes("\0signed", 7)}};
  batch.steady = UtcTime{99};
  REQUIRE(bench.db->save(batch));
  bench.open();
  const StoredState stored = bench.loaded();
  CHECK(stored.users == std::vector<User>{*bench.parts.users.find("ann")});
  CHECK(stored.requests == batch.requests);
  REQUIRE(stored.sessions.size() == 1);
  CHECK(stored.sessions[0].key == batch.sessions[0].row->key);
  REQUIRE(stored.tokens.size() == 1);
  CHECK(stored.tokens[0].key == batch.tokens[0].row->key);
  REQUIRE(stored.last_audit);
  CHECK(stored.last_audit->record.who == odd);
  CHECK(stored.last_audit->hash == batch.audit[0].hash);
  CHECK(stored.signed_to == 1);
  CHECK(bench.db->heads()->at(0) == batch.heads[0]);
  CHECK(stored.steady == UtcTime{99});
}

TEST_CASE("store: what was dropped is gone") {
  StoreBench bench;
  bench.parts.add("ann", UserRole::admin);
  bench.parts.add("bob");
  REQUIRE(bench.db->save(users_of(bench.parts)));
  REQUIRE(bench.parts.users.remove("bob"));
  StoreBatch batch = users_of(bench.parts);
  batch.requests = {{{"ann", "k"}, Bytes(32, 'd'), "start", UtcTime{8}, std::nullopt}};
  REQUIRE(bench.db->save(batch));
  StoreBatch later;
  later.dropped_requests = {{"ann", "k"}};
  REQUIRE(bench.db->save(later));
  CHECK(bench.loaded().users.size() == 1);
  CHECK(bench.loaded().requests.empty());
}

TEST_CASE("store: a batch that cannot be written whole is not written at all") {
  StoreBench bench;
  bench.parts.add("ann", UserRole::admin);
  StoreBatch batch = users_of(bench.parts);
  AuditRow row = bench.chain.append(done_by("ann"));
  row.record.number = 5;  // a gap: another gateway has written
  batch.audit = {row};
  const Status refused = bench.db->save(batch);
  REQUIRE_FALSE(refused);
  CHECK(refused.error().code == Errc::conflict);
  CHECK_FALSE(refused.error().hint.empty());
  CHECK(bench.loaded().users.empty());
}

TEST_CASE("store: two gateways together do not remove the last admin") {
  StoreBench bench;
  bench.parts.add("ann", UserRole::admin);
  bench.parts.add("bob", UserRole::admin);
  REQUIRE(bench.db->save(users_of(bench.parts)));
  Parts other;
  for (const User& user : bench.loaded().users) other.users.restore(user);
  REQUIRE(bench.parts.users.set_disabled("ann", true));
  REQUIRE(bench.db->save(users_of(bench.parts)));
  REQUIRE(other.users.set_role("bob", UserRole::viewer));  // this gateway believes in ann
  const Status refused = bench.db->save(users_of(other));
  REQUIRE_FALSE(refused);
  CHECK(refused.error().code == Errc::conflict);
  CHECK(bench.loaded().users[1].role == UserRole::admin);
}

TEST_CASE("store: the audit log is read page by page, the newest first, and cannot be changed by mistake") {
  StoreBench bench;
  StoreBatch batch;
  for (int i = 0; i < 30; ++i) batch.audit.push_back(bench.chain.append(done_by(i % 3 == 0 ? "ann" : "bob")));
  REQUIRE(bench.db->save(batch));
  const auto page = bench.db->audit({.before = {}, .most = 10, .who = ""});
  REQUIRE(page);
  CHECK(page->front().record.number == 30);
  CHECK(bench.db->audit({.before = page->back().record.number, .most = 10, .who = ""})->front().record.number == 20);
  CHECK(bench.db->audit({.before = {}, .most = 1000, .who = "ann"})->size() == 10);
  CHECK_FALSE(bench.db->audit({.before = {}, .most = 0, .who = ""}));
  CHECK_FALSE(bench.db->audit({.before = {}, .most = 1001, .who = ""}));
  CHECK(bench.by_hand("DELETE FROM audit WHERE number = 30") != SQLITE_OK);
  CHECK(bench.by_hand("UPDATE audit SET who = 'eve'") != SQLITE_OK);
  CHECK(verify_audit(kStart, *bench.db->audit_from(1, 100), {}).good == 30);
}

TEST_CASE("store: the file is its owner's alone, and one of a newer build is left as it is") {
  StoreBench bench;
  struct stat found {};
  REQUIRE(::stat(bench.path.c_str(), &found) == 0);
  CHECK((found.st_mode & 0777U) == 0600U);
  bench.db.reset();
  REQUIRE(bench.by_hand("PRAGMA user_version = 99") == SQLITE_OK);
  const auto refused = GatewayDb::open(bench.path);
  REQUIRE_FALSE(refused);
  CHECK_FALSE(refused.error().hint.empty());
}

TEST_CASE("store: kill -9 at any moment loses nothing that was acknowledged, and the chain goes on") {
  StoreBench bench;
  bench.db.reset();
  int told[2];
  REQUIRE(::pipe(told) == 0);
  const pid_t child = ::fork();
  if (child == 0) {
    const auto db = GatewayDb::open(bench.path);
    for (std::uint64_t i = 1; db; ++i) {
      StoreBatch batch;
      batch.audit = {bench.chain.append(done_by("ann"))};
      if (!(*db)->save(batch) || ::write(told[1], &i, sizeof i) != sizeof i) break;
    }
    ::_exit(1);
  }
  std::uint64_t last = 0;
  while (last < 50) REQUIRE(::read(told[0], &last, sizeof last) == sizeof last);
  ::kill(child, SIGKILL);
  ::waitpid(child, nullptr, 0);
  ::close(told[1]);
  for (std::uint64_t more = 0; ::read(told[0], &more, sizeof more) == sizeof more;) last = more;
  ::close(told[0]);
  bench.open();
  const auto rows = bench.db->audit_from(1, 1'000'000);
  REQUIRE(rows);
  CHECK(rows->size() >= last);
  CHECK(verify_audit(kStart, *rows, {}).good == rows->size());
  AuditChain after(kStart, rows->back());
  StoreBatch batch;
  batch.audit = {after.append(done_by("ann"))};
  CHECK(bench.db->save(batch));
}
