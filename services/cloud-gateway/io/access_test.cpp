// Two gateways' memories on one database: each decides on what is there, and nothing of the other's is lost.
#include <poll.h>

#include "common/audit/audit_verify.hpp"
#include "services/cloud-gateway/io/test/two_gateways.hpp"

using namespace trb;
using namespace trb::gateway;
using namespace trb::gateway::test;

namespace {

Alert alert_of(const std::string& id) {
  Alert out;
  out.id = id;
  out.robot = "ridgeback";
  out.cause = "robot_fault";
  out.severity = Severity::critical;
  out.time = kNow.ns;
  return out;
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
    const UtcTime now = kNow;
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
      auto begun = dies.access->requests.begin(key, "digest", "release of pioneer1", kNow);
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

TEST_CASE("a new scenario that is refused because another gateway was quicker was not made: its key is free again") {
  on_postgres([] {
    const TwoGateways both;
    const RequestKey key{"ann", "key-1"};
    Access& mine = *both.a.access;
    const auto begin = [&] { return mine.requests.begin(key, "digest", "a scenario", kNow); };
    mine.keep(std::get<Idempotency::Act>(*begin()).store);
    REQUIRE(mine.commit());
    both.b.refresh();
    REQUIRE(both.b.access->scenarios.add({"{}", "theirs", 0}, "bob", kNow).ok());
    REQUIRE(both.b.access->commit());
    REQUIRE(mine.scenarios.add({"{}", "mine", 0}, "ann", kNow).ok());
    mine.keep(*mine.requests.finish(key, {201, "{}"}));
    CHECK(mine.commit().error().code == Errc::conflict);
    CHECK(mine.scenarios.all().size() == 1);
    CHECK(loaded(*both.a.db).requests.empty());
    both.b.refresh();
    CHECK(both.b.access->requests.find(key) == nullptr);
    const auto again = begin();
    REQUIRE(again.ok());
    CHECK(std::holds_alternative<Idempotency::Act>(*again));
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
    const UtcTime now = kNow;
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

BOTH_STORES("a machine that was off for the night: when its clock is taken over, who has signed in since stays so") {
  init_crypto();
  const StoreFolder folder;
  Now now{{1}, kNow};
  const auto pass = [&](Duration by) {
    now.mono = now.mono + by;
    now.utc = now.utc + by;
  };
  std::string evening;
  {
    const OneGateway gateway{folder, "cloud"};
    const UtcTime steady = gateway.access->steady(now).time;
    REQUIRE(gateway.access->users.add("ann", UserRole::admin, "hash", steady));
    evening = gateway.access->sessions.open(*gateway.access->users.find("ann"), steady).id;
    REQUIRE(gateway.access->commit());
  }
  pass(std::chrono::hours(14));
  std::string morning;
  {
    const OneGateway gateway{folder, "cloud"};
    Access& access = *gateway.access;
    CHECK(access.steady(now).time == kNow);
    pass(std::chrono::minutes(1));
    const UtcTime steady = access.steady(now).time;
    morning = access.sessions.open(*access.users.find("ann"), steady).id;
    REQUIRE(access.tokens.make({"crane", UserRole::viewer, true, std::chrono::hours(24), "ann"}, steady).ok());
    REQUIRE(access.commit());
    pass(SteadyTime::kSteady);
    const Access::Steady stepped = access.steady(now);
    CHECK(stepped.has_stepped);
    CHECK(stepped.time == now.utc);
    access.tick(now, stepped.time);
    REQUIRE(access.commit());
    CHECK(access.sessions.find(morning, access.users, stepped.time) != nullptr);
    CHECK(access.sessions.find(evening, access.users, stepped.time) == nullptr);
    CHECK(access.tokens.all().at("crane").ends == now.utc - SteadyTime::kSteady + std::chrono::hours(24));
  }
  const OneGateway again{folder, "cloud"};
  const UtcTime steady = again.access->steady(now).time;
  CHECK(steady == now.utc);
  CHECK(again.access->sessions.find(morning, again.access->users, steady) != nullptr);
}

BOTH_STORES("the clock steps: keys of requests, answered and under way, are kept for as long as they would have been") {
  init_crypto();
  const StoreFolder folder;
  Now now{{1'000'000'000'000}, kNow};
  const auto pass = [&](Duration by) { now = {now.mono + by, now.utc + by}; };
  const RequestKey done{"ann", "done"};
  const RequestKey open{"ann", "open"};
  const OneGateway gateway{folder, "cloud"};
  Access& access = *gateway.access;
  static_cast<void>(access.steady(now));
  pass(std::chrono::seconds(1));
  for (const RequestKey& key : {done, open}) {
    auto begun = access.requests.begin(key, "digest", "a run", access.steady(now).time);
    REQUIRE(begun.ok());
    access.keep(std::get<Idempotency::Act>(*begun).store);
    REQUIRE(access.commit());
  }
  auto answered = access.requests.finish(done, {201, "{}"});
  REQUIRE(answered);
  access.keep(*answered);
  REQUIRE(access.commit());
  now.utc = now.utc + std::chrono::hours(30);
  static_cast<void>(access.steady(now));
  pass(SteadyTime::kSteady + std::chrono::seconds(1));
  REQUIRE(access.steady(now).has_stepped);
  const Status written = access.commit();
  CHECK_MESSAGE(written.ok(), (written ? "" : written.error().text()));
  for (const StoredRequest& one : loaded(*gateway.db).requests) {
    CHECK(one.since == kNow + std::chrono::seconds(1) + std::chrono::hours(30));
    CHECK(one.answer.has_value() == (one.key == done));
  }
  auto late = access.requests.finish(open, {201, "{}"});
  REQUIRE(late);
  access.keep(*late);
  CHECK(access.commit().ok());
}
