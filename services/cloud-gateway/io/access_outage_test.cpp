// What becomes of records and signed heads while the database is away, or does not say what it has written.
#include <poll.h>

#include "common/audit/audit_verify.hpp"
#include "services/cloud-gateway/io/test/two_gateways.hpp"

using namespace trb;
using namespace trb::gateway;
using namespace trb::gateway::test;

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
