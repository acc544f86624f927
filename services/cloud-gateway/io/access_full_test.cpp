// A file on a disk without room: what waits for room, what is refused, and what goes on.
#include "common/audit/audit_verify.hpp"
#include "common/sqlite/sqlite_file.hpp"
#include "common/sqlite/test/full_disk.hpp"
#include "services/cloud-gateway/io/test/two_gateways.hpp"

using namespace trb;
using namespace trb::gateway;
using namespace trb::gateway::test;

namespace {

/// A gateway of its own file, with ann, an admin who is signed in.
struct FileGateway {
  FileGateway() {
    init_crypto();
    REQUIRE(is.access->users.add("ann", UserRole::admin, "hash", kNow));
    session = sign_in();
    is.access->steady({{}, kNow});
    REQUIRE(is.access->commit());
  }
  [[nodiscard]] NewSession sign_in() const { return is.access->sessions.open(*is.access->users.find("ann"), kNow); }
  [[nodiscard]] bool is_known(const NewSession& one, UtcTime now = kNow) const {
    return is.access->sessions.find(one.id, is.access->users, now) != nullptr;
  }
  /// What a next process would find.
  [[nodiscard]] StoredState on_disk() const { return loaded(*opened(folder)); }

  StoreFolder folder;
  OneGateway is{folder, "cloud"};
  NewSession session;
};

const AuditRecord kStop{0, 7, "ann", "::1", "POST /api/v1/stop", "", "done"};

}  // namespace

TEST_CASE("a full disk: what somebody has decided is refused and undone, and who is signed in stays so") {
  const FileGateway gateway;
  Access& access = *gateway.is.access;
  const NewSession other = gateway.sign_in();
  REQUIRE(access.commit());
  {
    const trb::test::FullDisk full(1);
    REQUIRE(access.users.add("bob", UserRole::viewer, "hash", kNow));
    REQUIRE(access.users.set_password("ann", "another hash", false));
    access.sessions.end(other.id);
    access.note(kStop);
    const Status refused = access.commit();
    REQUIRE_FALSE(refused.ok());
    CHECK(refused.error().code == Errc::io_error);
    REQUIRE(access.unwritten());
    CHECK(access.users.find("bob") == nullptr);
    CHECK(access.users.find("ann")->password_hash == "hash");
    for (const NewSession& one : {gateway.session, other}) CHECK(gateway.is_known(one));
    access.steady({MonotonicTime{} + std::chrono::seconds(1), kNow + std::chrono::seconds(1)});
    CHECK(access.retry());
    CHECK(access.unwritten());
  }
  REQUIRE(access.retry());
  CHECK_FALSE(access.unwritten());
  CHECK(gateway.on_disk().users.size() == 1);
  REQUIRE(access.users.add("bob", UserRole::viewer, "hash", kNow));
  REQUIRE(access.commit());
  CHECK(gateway.on_disk().users.size() == 2);
}

TEST_CASE("a full disk: people sign in, use their sessions and sign out, and it is written once there is room") {
  const FileGateway gateway;
  Access& access = *gateway.is.access;
  NewSession late;
  const UtcTime later = kNow + std::chrono::minutes(20);
  {
    const trb::test::FullDisk full(1);
    late = gateway.sign_in();
    CHECK(access.commit());
    CHECK(access.unwritten());
    CHECK(gateway.is_known(late, later));
    CHECK(access.commit());
    access.sessions.end(gateway.session.id);
    CHECK(access.commit());
    CHECK(access.commit());  // of a page, with nothing to write
    // Refused, and undone: of the sessions nothing is.
    REQUIRE(access.users.add("bob", UserRole::viewer, "hash", kNow));
    CHECK_FALSE(access.commit().ok());
    CHECK(gateway.is_known(late, later));
    CHECK_FALSE(gateway.is_known(gateway.session));
  }
  REQUIRE(access.retry());
  const StoredState stored = gateway.on_disk();
  REQUIRE(stored.sessions.size() == 1);
  CHECK(stored.sessions[0].used == later);
}

TEST_CASE("a full disk: a stop's records are owed, and follow in the one chain; the gateway's own, too") {
  const FileGateway gateway;
  Access& access = *gateway.is.access;
  const Now now{MonotonicTime{} + std::chrono::minutes(2), kNow};
  {
    const trb::test::FullDisk full(1);
    access.note(kStop);
    CHECK_FALSE(access.commit().ok());
    CHECK(access.owe(kStop));
    for (int i = 0; i < 2; ++i) static_cast<void>(access.refusals.is_recorded({0, 8, "eve", "::1", "x", "", "no"}, {}));
    access.tick(now, kNow);
    CHECK(access.commit());
    CHECK(access.owed() == 2);
    CHECK_FALSE(access.retry().ok());
    CHECK(access.owed() == 2);
  }
  REQUIRE(access.retry());
  CHECK(access.owed() == 0);
  const auto rows = *gateway.is.db->audit_from(1, 10);
  REQUIRE(rows.size() == 2);
  CHECK(rows[0].record.action == kStop.action);
  CHECK(rows[1].record.action == "refusals");
  CHECK_FALSE(verify_audit(audit_start("fleet", "cloud"), rows, {}).fault);
}

TEST_CASE("a full disk: the answer of a request and its freed key wait; an intent does not") {
  const FileGateway gateway;
  Access& access = *gateway.is.access;
  const StoredRequest intent{{"ann", "key"}, "digest", "run", kNow, std::nullopt};
  StoredRequest answer = intent;
  answer.answer = StoredAnswer{201, "{}"};
  access.keep(intent);
  REQUIRE(access.commit());
  {
    const trb::test::FullDisk full(1);
    access.keep({{"ann", "other"}, "digest", "run", kNow, std::nullopt});
    CHECK_FALSE(access.commit().ok());
    access.keep(answer);
    CHECK(access.commit());
    access.drop({"ann", "key"});
    CHECK(access.commit());
    access.keep(answer);
    CHECK(access.commit());
  }
  REQUIRE(access.retry());
  const auto stored = gateway.on_disk().requests;
  REQUIRE(stored.size() == 1);
  CHECK(stored[0] == answer);
}

TEST_CASE("a gateway whose file is there starts on a full disk: by what is in it people stop robots") {
  const FileGateway gateway;
  const trb::test::FullDisk full(1);
  const OneGateway again(gateway.folder, "cloud");
  CHECK(again.access->sessions.find(gateway.session.id, again.access->users, kNow) != nullptr);
}

TEST_CASE("a file from a backup: the log says so before all else, with a number that was never given, once") {
  FileGateway gateway;
  gateway.is.note("ann");
  REQUIRE(gateway.is.access->commit());
  REQUIRE((*SqliteFile::open(gateway.folder.file(), ""))
              ->script("INSERT INTO meta VALUES('restored', 1800000000000000000)"));
  {
    const OneGateway again(gateway.folder, "cloud");
    again.access->note_restored(kNow);
    {
      const trb::test::FullDisk full(1);
      CHECK(again.access->commit());  // as at a start: it waits
    }
    again.note("bob");
    REQUIRE(again.access->commit());
  }
  const OneGateway last(gateway.folder, "cloud");
  last.access->note_restored(kNow);
  REQUIRE(last.access->commit());
  const auto rows = *last.db->audit_from(1, 10);
  REQUIRE(rows.size() == 3);
  CHECK(rows[1].record.number == static_cast<std::uint64_t>(kNow.ns / 1'000'000));
  CHECK(rows[1].record.who == "console");
  CHECK(rows[1].record.about == "from the backup of 2027-01-15T08:00:00.000Z");
  CHECK(rows[2].record.who == "bob");
  const AuditReport report = verify_audit(audit_start("fleet", "cloud"), rows, {});
  CHECK_FALSE(report.fault);
  CHECK(report.restored.size() == 1);
}

TEST_CASE("a full disk while the clock steps: a request's key moves along, and is written once there is room") {
  const FileGateway gateway;
  Access& access = *gateway.is.access;
  Now now{MonotonicTime{} + std::chrono::seconds(1), kNow + std::chrono::seconds(1)};
  const RequestKey key{"ann", "key-1"};
  auto begun = access.requests.begin(key, "digest", "a run", access.steady(now).time);
  REQUIRE(begun.ok());
  access.keep(std::get<Idempotency::Act>(*begun).store);
  REQUIRE(access.commit());
  {
    const trb::test::FullDisk full(1);
    now.utc = now.utc + std::chrono::hours(30);
    static_cast<void>(access.steady(now));
    now = {now.mono + SteadyTime::kSteady + std::chrono::seconds(1), now.utc + SteadyTime::kSteady};
    REQUIRE(access.steady(now).has_stepped);
    CHECK(access.commit());
    CHECK(access.unwritten());
    auto answer = access.requests.finish(key, {201, "{}"});
    REQUIRE(answer);
    access.keep(*answer);
    CHECK(access.commit());
  }
  REQUIRE(access.retry());
  const StoredState disk = gateway.on_disk();
  REQUIRE(disk.requests.size() == 1);
  CHECK(disk.requests[0].answer.has_value());
  CHECK(disk.requests[0].since >= kNow + std::chrono::hours(29));
}
