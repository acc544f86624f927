// Two gateways' memories on one database: each decides on what is there, and nothing of the other's is lost.
#include "services/cloud-gateway/io/access.hpp"

#include <doctest/doctest.h>
#include <poll.h>

#include "common/audit/audit_verify.hpp"
#include "common/security/keys.hpp"
#include "services/cloud-gateway/io/store/test/store_folder.hpp"

using namespace trb;
using namespace trb::gateway;
using namespace trb::gateway::test;

namespace {

constexpr UtcTime kNow{1'800'000'000'000'000'000};
const std::vector<std::string> kOrigins{"https://localhost:8443"};

/// A gateway: its connection, and its memory.
struct OneGateway {
  OneGateway(const StoreFolder& folder, const std::string& node) : db(opened(folder, node)) {
    auto made = Access::open(*db, kOrigins, {"fleet", node});
    REQUIRE_MESSAGE(made.ok(), (made ? "" : made.error().text()));
    access = std::move(*made);
  }
  void note(const std::string& who) const { access->note({0, 5, who, "::1", "POST /api/v1/runs", "run-1", "done"}); }
  void refresh() const { REQUIRE(access->refresh().ok()); }

  std::unique_ptr<GatewayDb> db;
  std::unique_ptr<Access> access;
};

/// Two gateways with ann, an admin, and bob, another one.
struct TwoGateways {
  TwoGateways() {
    init_crypto();
    REQUIRE(a.access->users.add("ann", UserRole::admin, "hash", kNow));
    REQUIRE(a.access->users.add("bob", UserRole::admin, "hash", kNow));
    REQUIRE(a.access->commit());
    b.refresh();
  }
  [[nodiscard]] NewSession sign_in(const std::string& user) const {
    NewSession out = a.access->sessions.open(*a.access->users.find(user), kNow);
    REQUIRE(a.access->commit());
    b.refresh();
    return out;
  }
  [[nodiscard]] bool is_known(const OneGateway& gateway, const NewSession& session, UtcTime now = kNow) const {
    return gateway.access->sessions.find(session.id, gateway.access->users, now) != nullptr;
  }

  StoreFolder folder;
  OneGateway a{folder, "cloud"};
  OneGateway b{folder, "cloud2"};
};

Alert alert_of(const std::string& id) {
  Alert out;
  out.id = id;
  out.robot = "ridgeback";
  out.cause = "robot_fault";
  out.severity = Severity::critical;
  out.time = kNow.ns;
  return out;
}

void on_postgres(void (*body)()) {
  with_store(true, body);
}

}  // namespace

TEST_CASE("who signs in at one gateway is known at the other, and who signs out is not") {
  on_postgres([] {
    const TwoGateways both;
    const NewSession session = both.sign_in("ann");
    CHECK(both.is_known(both.b, session));
    both.b.access->sessions.end(session.id);
    REQUIRE(both.b.access->commit());
    both.a.refresh();
    CHECK_FALSE(both.is_known(both.a, session));
  });
}

TEST_CASE("a session that ends at one gateway while the other one notes its use stays ended") {
  on_postgres([] {
    const TwoGateways both;
    const NewSession session = both.sign_in("ann");
    both.a.access->sessions.end(session.id);
    REQUIRE(both.a.access->commit());
    const UtcTime later = kNow + std::chrono::minutes(5);
    CHECK(both.is_known(both.b, session, later));  // it has not looked yet
    both.b.note("ann");
    REQUIRE(both.b.access->commit());
    CHECK_FALSE(both.is_known(both.b, session, later));
    CHECK(loaded(*both.a.db).sessions.empty());
    CHECK((*both.a.db->audit_from(1, 10)).size() == 1);
  });
}

TEST_CASE("two admins who remove each other at the same time: the second is refused, and sees why") {
  on_postgres([] {
    const TwoGateways both;
    REQUIRE(both.a.access->users.remove("bob"));
    REQUIRE(both.b.access->users.remove("ann"));
    REQUIRE(both.a.access->commit());
    const Status lost = both.b.access->commit();
    REQUIRE_FALSE(lost.ok());
    CHECK(lost.error().code == Errc::conflict);
    CHECK_FALSE(lost.error().hint.empty());
    CHECK(both.b.access->users.find("ann") != nullptr);  // memory is the database's again
    CHECK(both.b.access->users.find("bob") == nullptr);
    CHECK(both.b.access->users.remove("ann").error().code == Errc::conflict);
  });
}

TEST_CASE("both write the audit log at the same time: one chain, without a gap, of all that both have done") {
  on_postgres([] {
    const TwoGateways both;
    for (int i = 0; i < 5; ++i) {
      both.a.note("ann");
      both.b.note("bob");
      both.b.note("bob");
      REQUIRE(both.a.access->commit());
      REQUIRE(both.b.access->commit());
    }
    const auto rows = *both.a.db->audit_from(1, 100);
    REQUIRE(rows.size() == 15);
    CHECK_FALSE(verify_audit(audit_start("fleet", "cloud"), rows, {}).fault);
    both.a.refresh();
    CHECK(both.a.access->chain.number() == 15);
    CHECK(both.b.access->chain.number() == 15);
  });
}

TEST_CASE("one key at both at the same time is begun once, and the other gateway gives its answer") {
  on_postgres([] {
    const TwoGateways both;
    const RequestKey key{"ann", "key-1"};
    const Now now{{1}, kNow};
    const auto begin = [&](const OneGateway& gateway) {
      auto begun = gateway.access->requests.begin(key, "digest", "run-1", now);
      REQUIRE(begun.ok());
      if (auto* act = std::get_if<Idempotency::Act>(&*begun)) gateway.access->keep(act->store);
      return *begun;
    };
    begin(both.a);
    begin(both.b);
    REQUIRE(both.a.access->commit());
    CHECK(both.b.access->commit().error().code == Errc::conflict);
    CHECK(std::holds_alternative<Idempotency::Wait>(begin(both.b)));
    auto answer = both.a.access->requests.finish(key, {201, "{}"});
    REQUIRE(answer);
    both.a.access->keep(*answer);
    both.b.note("bob");
    REQUIRE(both.b.access->commit());
    both.a.note("ann");
    REQUIRE(both.a.access->commit());
    both.b.refresh();
    const auto repeat = begin(both.b);
    REQUIRE(std::holds_alternative<StoredAnswer>(repeat));
    CHECK(std::get<StoredAnswer>(repeat) == StoredAnswer{201, "{}"});
  });
}

TEST_CASE("a request whose gateway has died is settled by both others at once, and is on record once") {
  on_postgres([] {
    const TwoGateways both;
    const RequestKey key{"ann", "key-1"};
    {
      const OneGateway dies{both.folder, "cloud3"};
      auto begun = dies.access->requests.begin(key, "digest", "release of pioneer1", Now{{1}, kNow});
      REQUIRE(begun.ok());
      dies.access->keep(std::get<Idempotency::Act>(*begun).store);
      REQUIRE(dies.access->commit());
    }
    for (const OneGateway* one : {&both.a, &both.b}) one->refresh();
    for (const OneGateway* one : {&both.a, &both.b}) {
      REQUIRE(one->access->requests.unsure().size() == 1);
      one->access->settle(*one->access->requests.finish(key, {503, "{}"}), kNow);
      one->note("bob");
    }
    REQUIRE(both.a.access->commit());
    REQUIRE(both.b.access->commit());
    const auto rows = *both.a.db->audit_from(1, 10);
    REQUIRE(rows.size() == 3);
    CHECK(rows[0].record.about == "release of pioneer1");
    CHECK(rows[0].record.outcome == "not confirmed");
    CHECK((rows[1].record.who == "bob" && rows[2].record.who == "bob"));
    CHECK(loaded(*both.a.db).requests[0].answer->status == 503);
  });
}

TEST_CASE("of two changes of one scenario the second is refused, and other people's work goes on beside it") {
  on_postgres([] {
    const TwoGateways both;
    const auto made = both.a.access->scenarios.add({"{}", "first", 0}, "ann", kNow);
    REQUIRE(made.ok());
    const std::string id = (*made)->id;
    REQUIRE(both.a.access->commit());
    both.b.refresh();
    REQUIRE(both.a.access->scenarios.change(id, {"{}", "left", 0}, "ann", kNow).ok());
    REQUIRE(both.b.access->scenarios.change(id, {"{}", "right", 0}, "bob", kNow).ok());
    REQUIRE(both.a.access->commit());
    CHECK(both.b.access->commit().error().code == Errc::conflict);
    CHECK(both.b.access->scenarios.find(id)->scenario.name == "left");
    CHECK(both.b.access->scenarios.find(id)->version == 2);
  });
}

TEST_CASE(
    "the server is gone: what was not written is not shown once it is back, and nothing has to be started again") {
  on_postgres([] {
    const TwoGateways both;
    postgres_turn()->kill();
    REQUIRE(both.b.access->users.add("eve", UserRole::viewer, "hash", kNow));
    CHECK(both.b.access->commit().error().code == Errc::peer_unreachable);
    CHECK_FALSE(both.b.access->refresh().ok());
    postgres_turn()->start();
    for (int tries = 0; tries < 1000 && !both.b.access->refresh(); ++tries) ::poll(nullptr, 0, 20);
    CHECK(both.b.access->users.find("eve") == nullptr);
    CHECK(both.b.access->users.find("ann") != nullptr);
    REQUIRE(both.b.access->users.add("eve", UserRole::viewer, "hash", kNow));
    CHECK(both.b.access->commit());
  });
}

TEST_CASE("a gateway that starts without its database knows nobody, and everybody once the database is there") {
  on_postgres([] {
    const TwoGateways both;
    postgres_turn()->kill();
    const auto db = open_shared_db(postgres_turn()->access(), {"cloud3", "c"}, std::chrono::milliseconds(100));
    auto access = Access::open(*db, kOrigins, {"fleet", "cloud3"});
    REQUIRE(access.ok());
    CHECK((*access)->users.all().empty());
    REQUIRE((*access)->users.add("eve", UserRole::admin, "hash", kNow));
    CHECK_FALSE((*access)->commit());
    postgres_turn()->start();
    for (int tries = 0; tries < 1000 && !(*access)->refresh(); ++tries) ::poll(nullptr, 0, 20);
    CHECK((*access)->users.all().size() == 2);
    CHECK((*access)->chain.head({0}).start.bytes == audit_start("fleet", "cloud"));
  });
}

TEST_CASE("an alarm that is acknowledged at one gateway is so at the other; of two people the first is kept") {
  on_postgres([] {
    const TwoGateways both;
    const Alert alert = alert_of("a1");
    for (const OneGateway* one : {&both.a, &both.b}) one->access->alarms.see({alert}, kNow);
    REQUIRE(both.a.access->alarms.acknowledge("a1", "ann", kNow));
    REQUIRE(both.b.access->alarms.acknowledge("a1", "bob", kNow));
    REQUIRE(both.b.access->alarms.shelve("a1", "bob", std::chrono::minutes(1), "why", kNow));
    REQUIRE(both.a.access->commit());
    both.b.note("bob");
    REQUIRE(both.b.access->commit());
    both.a.refresh();
    for (const OneGateway* one : {&both.a, &both.b}) {
      CHECK(one->access->alarms.of("a1").acknowledged_by == "ann");
      CHECK(one->access->alarms.of("a1").shelved_by == "bob");
    }
    REQUIRE(both.a.access->alarms.unshelve("a1"));
    REQUIRE(both.a.access->commit());
    both.b.refresh();
    CHECK(both.b.access->alarms.of("a1").shelved_by.empty());
  });
}

TEST_CASE("a shelf whose time is over ends at both gateways, and is recorded once") {
  on_postgres([] {
    const TwoGateways both;
    for (const OneGateway* one : {&both.a, &both.b}) one->access->alarms.see({alert_of("a1")}, kNow);
    REQUIRE(both.a.access->alarms.shelve("a1", "ann", std::chrono::minutes(1), "why", kNow));
    REQUIRE(both.a.access->commit());
    both.b.refresh();
    const UtcTime over = kNow + std::chrono::minutes(1);
    for (const OneGateway* one : {&both.a, &both.b}) one->access->tick({{1}, over}, over);
    REQUIRE(both.a.access->commit());
    REQUIRE(both.b.access->commit());
    const auto rows = *both.a.db->audit_from(1, 10);
    REQUIRE(rows.size() == 1);
    CHECK(rows[0].record.action == "unshelve");
    CHECK(loaded(*both.a.db).shelves.empty());
    CHECK_FALSE(verify_audit(audit_start("fleet", "cloud"), rows, {}).fault);
  });
}

TEST_CASE(
    "a request that was not done leaves no trace: its key is free, also at the other gateway and after a restart") {
  on_postgres([] {
    const TwoGateways both;
    const RequestKey key{"ann", "key-1"};
    const Now now{{1}, kNow};
    auto begun = both.a.access->requests.begin(key, "digest", "run-1", now);
    REQUIRE(begun.ok());
    both.a.access->keep(std::get<Idempotency::Act>(*begun).store);
    REQUIRE(both.a.access->commit());
    both.b.refresh();
    CHECK(both.b.access->requests.find(key) != nullptr);
    REQUIRE(both.a.access->requests.release(key));
    both.a.access->drop(key);
    REQUIRE(both.a.access->commit());
    both.b.refresh();
    CHECK(both.b.access->requests.find(key) == nullptr);
    CHECK(loaded(*both.a.db).requests.empty());
  });
}

namespace {

/// A minute passes, and the node's router signs what the gateway asks it to. False: nothing was asked, or kept.
bool sign_head(const OneGateway& gateway, Now& now) {
  now.mono = now.mono + kHeadEvery;
  const auto head = gateway.access->heads.due(gateway.access->chain, now);
  return head && gateway.access->keep(*head, audit_head_payload(*head));
}

void come_back(const OneGateway& gateway) {
  for (int tries = 0; tries < 1000 && !gateway.access->refresh(); ++tries) ::poll(nullptr, 0, 20);
}

AuditReport verified(GatewayDb& db) {
  const auto stored = db.heads(1, 1000);
  REQUIRE(stored.ok());
  std::vector<AuditHead> heads;
  for (const SignedHead& one : *stored) heads.push_back(*read_audit_head(one.record));
  return verify_audit(audit_start("fleet", "cloud"), *db.audit_from(1, 1000), heads);
}

}  // namespace

namespace {

/// A database whose connection is cut after it has committed, and before it says so.
class CutAfterCommit final : public GatewayDb {
 public:
  explicit CutAfterCommit(GatewayDb& db) : db_(db) {}
  bool is_cut = false;

  [[nodiscard]] bool is_shared() const override { return db_.is_shared(); }
  Result<StoredState> load() override { return db_.load(); }
  Result<StoredState> refresh() override { return db_.refresh(); }
  Status save(const StoreBatch& batch) override {
    Status saved = db_.save(batch);
    return saved && is_cut ? Status(fail(Errc::peer_unreachable, "cut", "")) : saved;
  }
  Result<std::vector<AuditRow>> audit(const AuditQuery& query) override { return db_.audit(query); }
  Result<std::vector<AuditRow>> audit_from(std::uint64_t number, std::size_t most) override {
    return db_.audit_from(number, most);
  }
  Result<std::vector<SignedHead>> heads(std::uint64_t first, std::uint64_t last) override {
    return db_.heads(first, last);
  }
  Result<std::vector<Bytes>> certificates() override { return db_.certificates(); }

 private:
  GatewayDb& db_;
};

}  // namespace

TEST_CASE("a commit whose answer is lost: what it has written is not written again, what it has not is") {
  on_postgres([] {
    const TwoGateways both;
    CutAfterCommit cut(*both.a.db);
    auto access = Access::open(cut, kOrigins, {"fleet", "cloud"});
    REQUIRE(access.ok());
    const auto order = [&](std::int64_t time, const std::string& who) {
      const AuditRecord record{0, time, who, "::1", "POST /api/v1/stop", std::string(300, 'x'), "done"};
      (*access)->note(record);
      CHECK_FALSE((*access)->commit());
      CHECK((*access)->owe(record));
    };
    cut.is_cut = true;
    order(7, "ann");  // stored
    cut.is_cut = false;
    order(8, "ann");  // not read again yet, so refused
    order(8, "bob");
    both.b.note("bob");
    REQUIRE(both.b.access->commit());
    REQUIRE((*access)->refresh().ok());
    cut.is_cut = true;
    CHECK_FALSE((*access)->pay_owed());
    cut.is_cut = false;
    REQUIRE((*access)->refresh().ok());
    REQUIRE((*access)->pay_owed());
    CHECK((*access)->owed() == 0);
    const auto rows = *both.a.db->audit_from(1, 10);
    REQUIRE(rows.size() == 4);
    CHECK(rows[0].record.time == 7);
    CHECK(rows[1].record.time == 5);
    CHECK((rows[2].record.time == 8 && rows[2].record.who == "ann"));
    CHECK((rows[3].record.time == 8 && rows[3].record.who == "bob"));
    CHECK_FALSE(verify_audit(audit_start("fleet", "cloud"), rows, {}).fault);
  });
}

TEST_CASE("a head that is signed while the server is gone accuses nobody of what was never written") {
  on_postgres([] {
    const TwoGateways both;
    Now now{{1}, kNow};
    for (const OneGateway* one : {&both.a, &both.b}) {
      one->note("ann");
      REQUIRE(one->access->commit());
    }
    postgres_turn()->kill();
    for (const OneGateway* one : {&both.a, &both.b}) {
      one->note("eve");  // what each of them orders meanwhile
      CHECK_FALSE(one->access->commit());
      CHECK_FALSE(sign_head(*one, now));
    }
    postgres_turn()->start();
    for (const OneGateway* one : {&both.a, &both.b}) come_back(*one);
    for (const OneGateway* one : {&both.a, &both.b}) {
      one->refresh();
      one->note("bob");
      REQUIRE(one->access->commit());
      REQUIRE(sign_head(*one, now));
      one->note("bob");
      REQUIRE(one->access->commit());
    }
    const AuditReport report = verified(*both.a.db);
    CHECK_MESSAGE(!report.fault, (report.fault ? report.fault->what : ""));
    CHECK(report.good == 6);
    CHECK(report.covered == 5);
  });
}

TEST_CASE("a head is kept of a stored record alone, and survives a write that fails") {
  on_postgres([] {
    const TwoGateways both;
    Now now{{1}, kNow};
    both.a.note("ann");
    REQUIRE(both.a.access->commit());
    AuditChain other(audit_start("fleet", "cloud"));
    other.append({0, 5, "eve", "::1", "POST /api/v1/runs", "run-1", "done"});
    CHECK_FALSE(both.a.access->keep(other.head(kNow), audit_head_payload(other.head(kNow))));
    other.append({0, 5, "eve", "::1", "POST /api/v1/runs", "run-1", "done"});
    CHECK_FALSE(both.a.access->keep(other.head(kNow), audit_head_payload(other.head(kNow))));
    REQUIRE(sign_head(both.a, now));
    postgres_turn()->kill();
    both.a.note("ann");
    CHECK_FALSE(both.a.access->commit());
    postgres_turn()->start();
    come_back(both.a);
    both.a.note("ann");
    REQUIRE(both.a.access->commit());
    const AuditReport report = verified(*both.a.db);
    CHECK_FALSE(report.fault);
    CHECK(report.good == 2);
    CHECK(report.covered == 1);
  });
}

TEST_CASE("a head that waits for the server fails no reply that has nothing to write") {
  on_postgres([] {
    const TwoGateways both;
    Now now{{1}, kNow};
    both.a.note("ann");
    REQUIRE(both.a.access->commit());
    REQUIRE(sign_head(both.a, now));
    postgres_turn()->kill();
    for (int i = 0; i < 3; ++i) CHECK(both.a.access->commit());  // of /health, or of a page
    both.a.note("ann");
    CHECK_FALSE(both.a.access->commit());
    CHECK(both.a.access->commit());
    postgres_turn()->start();
    come_back(both.a);
    REQUIRE(both.a.access->commit());
    const AuditReport report = verified(*both.a.db);
    CHECK_FALSE(report.fault);
    CHECK(report.covered == 1);
  });
}

TEST_CASE("a file that takes no head fails the commit, for it takes nothing else either") {
  const StoreFolder folder;
  const auto file = opened(folder);
  CutAfterCommit full(*file);
  auto access = Access::open(full, kOrigins, {"fleet", "cloud"});
  REQUIRE(access.ok());
  (*access)->note({0, 5, "ann", "::1", "POST /api/v1/runs", "run-1", "done"});
  REQUIRE((*access)->commit());
  const AuditHead head = (*access)->chain.head(kNow);
  REQUIRE((*access)->keep(head, audit_head_payload(head)));
  full.is_cut = true;
  CHECK_FALSE((*access)->commit());
}

TEST_CASE("what was done while the server was gone is recorded once it is back, in the one chain") {
  on_postgres([] {
    const TwoGateways both;
    both.a.note("ann");
    REQUIRE(both.a.access->commit());
    postgres_turn()->kill();
    both.a.note("ann");
    CHECK_FALSE(both.a.access->commit().ok());
    CHECK(both.a.access->owe({0, 7, "ann", "::1", "POST /api/v1/stop", "", "done"}));
    CHECK_FALSE(both.a.access->pay_owed().ok());
    CHECK(both.a.access->owed() == 1);
    postgres_turn()->start();
    for (int tries = 0; tries < 1000 && !both.a.access->refresh(); ++tries) ::poll(nullptr, 0, 20);
    REQUIRE(both.a.access->pay_owed());
    CHECK(both.a.access->owed() == 0);
    const auto rows = *both.a.db->audit_from(1, 10);
    REQUIRE(rows.size() == 2);
    CHECK(rows[1].record.action == "POST /api/v1/stop");
    CHECK_FALSE(verify_audit(audit_start("fleet", "cloud"), rows, {}).fault);
  });
}
