// What is saved is loaded again the same; a batch is written whole or not at all.
#include <algorithm>
#include <limits>

#include "services/cloud-gateway/core/access/test/gateway_parts.hpp"
#include "services/cloud-gateway/io/store/test/store_folder.hpp"

using namespace trb;
using namespace trb::gateway;
using namespace trb::gateway::test;

namespace {

constexpr std::int64_t kFirstNs = std::numeric_limits<std::int64_t>::min();
constexpr std::int64_t kLastNs = std::numeric_limits<std::int64_t>::max();

Session session_of(const std::string& key, const std::string& user) {
  return {key, user, Bytes("\0\xff stamp", 8), {kFirstNs}, {kLastNs}};
}

Token token_of(const std::string& name) {
  return {name, UserRole::operator_, true, "ann", {1}, {kLastNs}, Bytes("\0key", 4)};
}

StoredRequest request_of(const std::string& user, const std::string& key) {
  return {{user, key}, Bytes("\0digest", 7), "run-7", {17}, std::nullopt};
}

StoredScenario scenario_of(const std::string& id) {
  return {id,
          {"{\"name\": \"'; DROP TABLE scenarios --\", \"tasks\": [{}]}\n", "'; DROP TABLE scenarios --", 1},
          3,
          "ann",
          {19}};
}

/// Something of each kind.
StoreBatch full_batch() {
  AuditChain chain(chain_start());
  StoreBatch out;
  out.users = {put(user_of("ann", UserRole::admin)), put(user_of("bob", UserRole::operator_, true))};
  out.sessions = {put(session_of(Bytes("\0k1", 3), "ann")), put(session_of("k2", "bob"))};
  out.tokens = {put(token_of("exporter")), put(token_of("screen"))};
  out.requests = {request_of("ann", "1"), request_of("ann", "2"), request_of("bob", "1")};
  out.requests[1].answer = StoredAnswer{201, Bytes("{\"id\":\"\0\"}", 10)};
  out.requests[2].answer = StoredAnswer{0, ""};
  out.scenarios = {{"a1", scenario_of("a1")}, {"b2", scenario_of("b2")}};
  out.acknowledged = {{"0a1b", Acknowledgement{"0a1b", "ann", {23}, Severity::fatal}}};
  out.shelves = {{"ant//'robot_fault", Shelf{"ant//'robot_fault", "ann", {29}, {kLastNs}, "'; DROP TABLE shelves --"}}};
  out.users[1].row->must_change = true;
  out.audit = records(chain, 3);
  out.heads = {{2, Bytes("\0signed", 7)}};
  out.steady = UtcTime{kLastNs};
  return out;
}

template <class Row>
std::vector<Row> rows_of(const std::vector<Change<Row>>& changes) {
  std::vector<Row> out;
  for (const Change<Row>& change : changes) out.push_back(*change.row);
  return out;
}

void check_holds(const StoredState& state, const StoreBatch& batch) {
  CHECK(state.users == rows_of(batch.users));
  CHECK(state.sessions == rows_of(batch.sessions));
  CHECK(state.tokens == rows_of(batch.tokens));
  CHECK(state.requests == batch.requests);
  CHECK(state.scenarios == rows_of(batch.scenarios));
  CHECK(state.acknowledged == rows_of(batch.acknowledged));
  CHECK(state.shelves == rows_of(batch.shelves));
  CHECK(state.last_audit == batch.audit.back());
  CHECK(state.signed_to == 2);
  CHECK(state.steady == batch.steady);
}

}  // namespace

BOTH_STORES("a new store is empty") {
  const StoreFolder folder;
  const auto db = opened(folder);
  const StoredState state = loaded(*db);
  CHECK(state.users.empty());
  CHECK(state.sessions.empty());
  CHECK(state.tokens.empty());
  CHECK(state.requests.empty());
  CHECK(state.scenarios.empty());
  CHECK(state.acknowledged.empty());
  CHECK(state.shelves.empty());
  CHECK_FALSE(state.last_audit);
  CHECK(state.signed_to == 0);
  CHECK_FALSE(state.steady);
  CHECK(db->heads(0, 1000)->empty());
  CHECK(StoreBatch{}.empty());
  CHECK(db->save({}));
}

BOTH_STORES("everything that is saved is loaded again the same, also after a restart") {
  const StoreFolder folder;
  const StoreBatch batch = full_batch();
  {
    const auto db = opened(folder);
    REQUIRE(db->save(batch));
    check_holds(loaded(*db), batch);
  }
  const auto db = opened(folder);
  check_holds(loaded(*db), batch);
  CHECK(*db->audit_from(1, 100) == batch.audit);
  CHECK(*db->heads(0, 1000) == batch.heads);
}

BOTH_STORES("a row with the same key is replaced, in the batch's order") {
  const StoreFolder folder;
  const auto db = opened(folder);
  REQUIRE(db->save(full_batch()));
  StoreBatch later;
  later.users = {put(user_of("ann", UserRole::admin, true)), put(user_of("cid", UserRole::admin)),
                 put(user_of("ann", UserRole::admin))};
  later.requests = {request_of("ann", "1")};
  later.requests[0].answer = StoredAnswer{409, "no"};
  later.steady = UtcTime{3};
  REQUIRE(db->save(later));
  const StoredState state = loaded(*db);
  REQUIRE(state.users.size() == 3);
  CHECK(state.users[0] == user_of("ann", UserRole::admin));
  CHECK(state.requests[0] == later.requests[0]);
  CHECK(state.steady == UtcTime{3});
}

BOTH_STORES("what is dropped is gone, what is not there to be dropped is no error") {
  const StoreFolder folder;
  const auto db = opened(folder);
  REQUIRE(db->save(full_batch()));
  StoreBatch drops;
  drops.users = {{"bob", std::nullopt}, {"nobody", std::nullopt}};
  drops.sessions = {{Bytes("\0k1", 3), std::nullopt}};
  drops.tokens = {{"screen", std::nullopt}};
  drops.scenarios = {{"a1", std::nullopt}};
  drops.dropped_requests = {{"ann", "1"}, {"bob", "7"}};
  REQUIRE(db->save(drops));
  REQUIRE(db->save(drops));
  const StoredState state = loaded(*db);
  CHECK(state.users.size() == 1);
  CHECK(state.sessions == std::vector<Session>{session_of("k2", "bob")});
  CHECK(state.tokens == std::vector<Token>{token_of("exporter")});
  CHECK(state.requests.size() == 2);
  CHECK(state.scenarios == std::vector<StoredScenario>{scenario_of("b2")});
}

BOTH_STORES("an expired key that is dropped and used again in one batch stays") {
  const StoreFolder folder;
  const auto db = opened(folder);
  REQUIRE(db->save(full_batch()));
  StoreBatch again;
  again.dropped_requests = {{"ann", "2"}};
  again.requests = {request_of("ann", "2")};
  REQUIRE(db->save(again));
  CHECK(loaded(*db).requests[1] == request_of("ann", "2"));
}

BOTH_STORES("a batch that fails half-way changes nothing, and the store can be used further") {
  const StoreFolder folder;
  const auto db = opened(folder);
  const StoreBatch batch = full_batch();
  REQUIRE(db->save(batch));
  StoreBatch half;
  half.users = {{"bob", std::nullopt}, put(user_of("eve", UserRole::admin))};
  half.sessions = {{"k2", std::nullopt}};
  half.tokens = {put(token_of("another"))};
  half.dropped_requests = {{"ann", "1"}};
  half.steady = UtcTime{1};
  half.audit = {batch.audit.back()};  // its number is there already
  CHECK(refused(*db, half).code == Errc::conflict);
  check_holds(loaded(*db), batch);
  half.audit.clear();
  REQUIRE(db->save(half));
  CHECK(loaded(*db).users.size() == 2);
}

BOTH_STORES("texts like SQL are stored as they are") {
  const std::vector<std::string> texts = {"'; DROP TABLE users; --",
                                          "\" OR 1=1 --",
                                          "a' OR 'a'='a",
                                          "%_*?1:x@y$z",
                                          std::string("nul\0behind", 10),
                                          "\xff\xfe no UTF-8",
                                          "",
                                          "\u00e4\U0001f916"};
  const StoreFolder folder;
  const auto db = opened(folder);
  AuditChain chain(chain_start());
  for (const std::string& text : texts) {
    CAPTURE(text);
    StoreBatch batch;
    batch.users = {put(User{text, UserRole::admin, text, false, {}, text})};
    batch.sessions = {put(Session{text, text, text, {}, {}})};
    batch.tokens = {put(Token{text, UserRole::viewer, false, text, {}, {}, text})};
    batch.requests = {{{text, text}, text, text, {}, StoredAnswer{200, text}}};
    batch.heads = {{chain.number() + 1, text}};
    batch.audit = {{{chain.number() + 1, 0, text, text, text, text, text}, text}};
    chain.append({});
    REQUIRE(db->save(batch));
    CHECK(loaded(*db).last_audit == batch.audit[0]);
    if (!text.empty()) CHECK(*db->audit({std::nullopt, 10, text}) == batch.audit);  // "" asks for everybody's
  }
  const StoredState state = loaded(*db);
  CHECK(state.users.size() == texts.size());
  for (const std::string& text : texts) {
    CHECK(std::ranges::count(state.users, User{text, UserRole::admin, text, false, {}, text}) == 1);
    CHECK(std::ranges::count(state.sessions, Session{text, text, text, {}, {}}) == 1);
    CHECK(std::ranges::count(state.tokens, Token{text, UserRole::viewer, false, text, {}, {}, text}) == 1);
    CHECK(std::ranges::count(state.requests, StoredRequest{{text, text}, text, text, {}, StoredAnswer{200, text}}) ==
          1);
  }
}

BOTH_STORES("the last enabled admin stays, though two gateways share the store") {
  const StoreFolder folder;
  const auto one = opened(folder);
  const auto two = opened(folder);
  StoreBatch admins;
  admins.users = {put(user_of("ann", UserRole::admin)), put(user_of("bob", UserRole::admin))};
  REQUIRE(one->save(admins));
  StoreBatch without_ann;
  without_ann.users = {{"ann", std::nullopt}};
  REQUIRE(one->save(without_ann));

  StoreBatch loss;
  SUBCASE("removed") {
    loss.users = {{"bob", std::nullopt}};
  }
  SUBCASE("disabled") {
    loss.users = {put(user_of("bob", UserRole::admin, true))};
  }
  SUBCASE("another role") {
    loss.users = {put(user_of("bob", UserRole::operator_))};
  }
  loss.tokens = {put(token_of("made in vain"))};
  const Error error = refused(*two, loss);
  CHECK(error.code == Errc::conflict);
  CHECK(error.what.find("no enabled admin") != std::string::npos);
  CHECK_FALSE(error.hint.empty());
  CHECK(loaded(*two).users == std::vector<User>{user_of("bob", UserRole::admin)});
  CHECK(loaded(*two).tokens.empty());

  loss.users.push_back(put(user_of("cid", UserRole::admin)));  // an heir in the same batch
  CHECK(two->save(loss));
}

BOTH_STORES("each of two gateways believes in the other's admin: the second change is refused") {
  const StoreFolder folder;
  const auto db = opened(folder);
  Parts one;
  one.add("ann", UserRole::admin);
  one.add("bob", UserRole::admin);
  const auto save = [&](Users& users) {
    StoreBatch batch;
    batch.users = users.take_changes();
    return db->save(batch);
  };
  REQUIRE(save(one.users));
  Parts two;
  for (const User& user : loaded(*db).users) two.users.restore(user);
  REQUIRE(one.users.set_disabled("ann", true));
  REQUIRE(save(one.users));
  REQUIRE(two.users.set_role("bob", UserRole::viewer));
  CHECK(save(two.users).error().code == Errc::conflict);
  CHECK(loaded(*db).users[1].role == UserRole::admin);
}

BOTH_STORES("a store without an admin takes other users") {
  const StoreFolder folder;
  const auto db = opened(folder);
  StoreBatch batch;
  batch.users = {put(user_of("ann"))};
  CHECK(db->save(batch));
  batch.users = {{"ann", std::nullopt}};
  CHECK(db->save(batch));
}
