// What several gateways share: what one writes the others see, of two that decide on the same the second is refused,
// and a server that is gone and comes back costs nobody anything that was acknowledged.
#include <poll.h>

#include <atomic>
#include <chrono>
#include <thread>

#include "services/cloud-gateway/core/access/test/gateway_parts.hpp"
#include "services/cloud-gateway/io/store/test/store_folder.hpp"

using namespace trb;
using namespace trb::gateway;
using namespace trb::gateway::test;

namespace {

using Clock = std::chrono::steady_clock;

constexpr Duration kPatience = std::chrono::seconds(60);

StoreBatch user_batch(const std::string& name, UserRole role = UserRole::viewer) {
  StoreBatch out;
  out.users = {put(user_of(name, role))};
  return out;
}

StoreKinds refreshed(GatewayDb& db) {
  const auto state = db.refresh();
  REQUIRE_MESSAGE(state.ok(), (state ? "" : state.error().text()));
  return state->kinds;
}

/// Two gateways, both with all that is there in memory.
struct Two {
  Two() {
    loaded(*one);
    loaded(*two);
    refreshed(*one);
  }
  StoreFolder folder;
  std::unique_ptr<GatewayDb> one = opened(folder, "cloud");
  std::unique_ptr<GatewayDb> two = opened(folder, "cloud2");
};

/// Until the call succeeds; how long that took.
template <class Call>
Duration until_done(Call call, Duration most) {
  const auto begin = Clock::now();
  while (!call()) {
    REQUIRE(Clock::now() - begin < most);
    ::poll(nullptr, 0, 20);  // a refused call is the only event there is
  }
  return Clock::now() - begin;
}

}  // namespace

TEST_CASE("what one gateway writes the other one sees, and nothing else") {
  with_store(true, [] {
    const Two both;
    CHECK(both.one->is_shared());
    CHECK(refreshed(*both.two).empty());
    REQUIRE(both.one->save(user_batch("ann", UserRole::admin)));
    CHECK(refreshed(*both.one).empty());  // its own
    const auto seen = both.two->refresh();
    REQUIRE(seen.ok());
    CHECK(seen->kinds == StoreKinds{StoreKind::users});
    CHECK(seen->users == std::vector<User>{user_of("ann", UserRole::admin)});
    CHECK(refreshed(*both.two).empty());
  });
}

TEST_CASE("of two that decide on the same users the second is refused until it has read them; other kinds go on") {
  with_store(true, [] {
    const Two both;
    REQUIRE(both.one->save(user_batch("ann", UserRole::admin)));
    const Error lost = refused(*both.two, user_batch("bob"));
    CHECK(lost.code == Errc::conflict);
    CHECK(lost.what.find("users") != std::string::npos);
    StoreBatch other;
    other.sessions = {put(Session{"k", "ann", "s", {1}, {1}})};
    CHECK(both.two->save(other));
    CHECK(refreshed(*both.two) == StoreKinds{StoreKind::users});
    CHECK(both.two->save(user_batch("bob")));
    CHECK(refreshed(*both.one) == StoreKinds{StoreKind::users, StoreKind::sessions});
  });
}

TEST_CASE("two records of one number: the second gateway is refused, reads the end, and goes on from there") {
  with_store(true, [] {
    const Two both;
    AuditChain one(chain_start());
    AuditChain two(chain_start());
    REQUIRE(both.one->save(audit_batch(records(one, 1))));
    CHECK(refused(*both.two, audit_batch(records(two, 1))).code == Errc::conflict);
    const auto end = both.two->refresh();
    REQUIRE(end.ok());
    AuditChain next(chain_start(), *end->last_audit);
    CHECK(both.two->save(audit_batch(records(next, 1))));
    CHECK((*both.one->audit_from(1, 10)).size() == 2);
  });
}

TEST_CASE("a key that the other gateway has stored is refused; its answer stays") {
  with_store(true, [] {
    const Two both;
    StoreBatch begun;
    begun.requests = {{{"ann", "k"}, "digest", "run-1", {1}, std::nullopt}};
    REQUIRE(both.one->save(begun));
    CHECK(refused(*both.two, begun).code == Errc::conflict);
    refreshed(*both.two);
    CHECK(refused(*both.two, begun).code == Errc::conflict);  // also if it has read it, and forgets to look
    StoreBatch answered = begun;
    answered.requests[0].answer = StoredAnswer{201, "{}"};
    REQUIRE(both.one->save(answered));
    refreshed(*both.two);
    answered.requests[0].answer = StoredAnswer{503, "late"};
    CHECK(refused(*both.two, answered).code == Errc::conflict);
    CHECK(loaded(*both.two).requests[0].answer->status == 201);
  });
}

TEST_CASE("the audit chain is of the gateway that came first, and both certificates are there") {
  with_store(true, [] {
    const Two both;
    CHECK(loaded(*both.one).chain_node == "cloud");
    CHECK(loaded(*both.two).chain_node == "cloud");
    CHECK(*both.one->certificates() == std::vector<Bytes>{"certificate of cloud", "certificate of cloud2"});
  });
}

TEST_CASE("a server that is killed and comes back: calls fail at once meanwhile, nothing acknowledged is lost") {
  with_store(true, [] {
    const StoreFolder folder;
    const auto db = opened(folder);
    AuditChain chain(chain_start());
    REQUIRE(db->save(audit_batch(records(chain, 3))));
    loaded(*db);
    postgres_turn()->kill();
    const Error gone = refused(*db, audit_batch(records(chain, 1)));
    CHECK(gone.code == Errc::peer_unreachable);
    CHECK_FALSE(gone.hint.empty());
    CHECK(gone.text().find("secret") == std::string::npos);
    const auto begin = Clock::now();
    for (int i = 0; i < 100; ++i) CHECK_FALSE(db->refresh().ok());
    CHECK(Clock::now() - begin < kPatience);  // each that waited would have taken 2 s
    postgres_turn()->start();
    const Duration back = until_done([&] { return db->refresh().ok(); }, kPatience);
    MESSAGE("back after " << std::chrono::duration_cast<std::chrono::milliseconds>(back).count() << " ms");
    CHECK(loaded(*db).last_audit->record.number == 3);
    AuditChain next(chain_start(), *loaded(*db).last_audit);
    CHECK(db->save(audit_batch(records(next, 1))));
  });
}

TEST_CASE("a server that takes longer to let anybody in than it is given at first is given more") {
  with_store(true, [] {
    struct Slow {
      Slow() { again("pre_auth_delay=3"); }
      ~Slow() { again("pre_auth_delay=0"); }
      Slow(const Slow&) = delete;
      Slow& operator=(const Slow&) = delete;
      static void again(const std::string& setting) {
        postgres_turn()->kill();
        postgres_turn()->start(setting);
      }
    };
    const StoreFolder folder;
    const Slow slow;
    const auto db = open_shared_db(postgres_turn()->access(), {"cloud", "c"}, {});
    until_done([&] { return db->load().ok(); }, kPatience);
  });
}

TEST_CASE("a server that stands still holds nobody up for longer than a bound") {
  with_store(true, [] {
    const StoreFolder folder;
    const auto db = opened(folder);
    loaded(*db);
    postgres_turn()->stand_still(true);
    const auto begin = Clock::now();
    const auto answer = db->refresh();
    const auto took = Clock::now() - begin;
    postgres_turn()->stand_still(false);
    REQUIRE_FALSE(answer.ok());
    CHECK(answer.error().code == Errc::peer_unreachable);
    CHECK(took < kServerTime);
    until_done([&] { return db->refresh().ok(); }, kPatience);
  });
}

TEST_CASE("a transaction whose end is cancelled too keeps nobody out: its connection is given up") {
  with_store(true, [] {
    const StoreFolder folder;
    const auto db = opened(folder);
    loaded(*db);
    AuditChain chain(chain_start());
    const auto rows = records(chain, 1);
    const PostgresHost& server = *postgres_turn();
    std::atomic<bool> is_over = false;
    // As a server without time for it does: by its statement_timeout, again and again.
    std::thread canceller([&] {
      while (!is_over)
        static_cast<void>(
            server.said("SELECT pg_cancel_backend(pid) FROM pg_stat_activity, generate_series(1, 5000) "
                        "WHERE application_name = 'trb-cloud-gateway'"));
    });
    const auto end = Clock::now() + std::chrono::seconds(3);
    while (Clock::now() < end) static_cast<void>(db->save(audit_batch(rows)));
    is_over = true;
    canceller.join();
    // Somebody asks more often than the server ends a transaction that stands still.
    until_done([&] { return db->refresh().ok(); }, kPatience);
    CHECK(loaded(*db).last_audit->record.number == 1);
  });
}

TEST_CASE("a wrong password, or no server, is told with the cure and without the password") {
  with_store(true, [] {
    PostgresServer server = postgres_turn()->access();
    SUBCASE("another password") {
      server.connection += " password='wrong secret'";
    }
    SUBCASE("no server") {
      server.connection += " host=/nowhere";
    }
    const auto db = open_shared_db(server, {"cloud", "c"}, std::chrono::milliseconds(500));
    until_done([&] { return db->load().error().what.find("has not answered yet") == std::string::npos; }, kPatience);
    const Error error = db->load().error();
    CHECK(error.code == Errc::peer_unreachable);
    CHECK(error.what.find("postgresql:///postgres") != std::string::npos);
    CHECK(error.text().find("secret") == std::string::npos);
    CHECK_FALSE(error.hint.empty());
  });
}

TEST_CASE("tables of a newer build are refused with a cure, and left as they are; older ones are brought up to date") {
  with_store(true, [] {
    const StoreFolder folder;
    loaded(*opened(folder));
    const PostgresHost& server = *postgres_turn();
    REQUIRE(server.said("UPDATE versions_of_tables SET number = 99 WHERE store = 'gateway'") == "");
    const auto db = open_shared_db(server.access(), {"cloud", "c"}, std::chrono::seconds(1));
    until_done([&] { return db->load().error().code == Errc::version_mismatch; }, kPatience);
    CHECK(db->load().error().what.find("schema version 99, this build knows 4") != std::string::npos);
    REQUIRE(server.said("DELETE FROM versions WHERE kind IN ('scenarios', 'acknowledged', 'shelves'); "
                        "DROP TABLE scenarios; DROP TABLE acknowledged; DROP TABLE shelves; "
                        "ALTER TABLE users DROP COLUMN must_change; "
                        "UPDATE versions_of_tables SET number = 1 WHERE store = 'gateway'") == "");
    until_done([&] { return db->load().ok(); }, kPatience);
    StoreBatch batch;
    batch.scenarios = {{"a1", StoredScenario{"a1", {"{}", "one", 0}, 1, "ann", {1}}}};
    CHECK(db->save(batch));
  });
}
