// A gateway's store of its own: a file in a folder, or an empty database of PostgreSQL; and tests that run with both.
#pragma once

#include <doctest/doctest.h>

#include <memory>
#include <string>
#include <vector>

#include "common/audit/audit_chain.hpp"
#include "common/base/test/temporary_folder.hpp"
#include "services/cloud-gateway/io/store/gateway_db.hpp"
#include "services/cloud-gateway/io/store/shared_db.hpp"
#include "services/cloud-gateway/io/store/test/postgres_server.hpp"

namespace trb::gateway::test {

/// The server, in the second run of a test that runs with both; nullptr: SQLite's turn.
inline PostgresHost*& postgres_turn() {
  static PostgresHost* server = nullptr;
  return server;
}

/// Runs `body` with SQLite, or with PostgreSQL if that is installed.
inline void with_store(bool is_postgres, void (*body)()) {
  PostgresHost* server = is_postgres ? PostgresHost::shared() : nullptr;
  if (is_postgres && server == nullptr) return;
  // Also when a REQUIRE fails, which throws: else the next test with SQLite would meet PostgreSQL.
  struct Turn {
    explicit Turn(PostgresHost* of) { postgres_turn() = of; }
    Turn(const Turn&) = delete;
    Turn& operator=(const Turn&) = delete;
    ~Turn() { postgres_turn() = nullptr; }
  };
  const Turn turn(server);
  body();
}

struct StoreFolder : TemporaryFolder {
  StoreFolder() {
    if (postgres_turn() != nullptr) postgres_turn()->empty();
  }
  [[nodiscard]] std::string file() const { return path + "/gateway.db"; }
};

/// A server may be slow on a loaded machine.
constexpr Duration kServerTime = std::chrono::seconds(30);

inline std::unique_ptr<GatewayDb> opened(const StoreFolder& folder, const std::string& node = "cloud") {
  if (postgres_turn() != nullptr)
    return open_shared_db(postgres_turn()->access(), {node, "certificate of " + node}, kServerTime);
  auto db = GatewayDb::open(folder.file());
  REQUIRE_MESSAGE(db.ok(), (db ? "" : db.error().text()));
  return std::move(*db);
}

inline StoredState loaded(GatewayDb& db) {
  auto state = db.load();
  REQUIRE_MESSAGE(state.ok(), (state ? "" : state.error().text()));
  return std::move(*state);
}

/// The error of a batch that must be refused.
inline Error refused(GatewayDb& db, const StoreBatch& batch) {
  const Status saved = db.save(batch);
  REQUIRE_FALSE(saved.ok());
  return saved.error();
}

inline Change<User> put(User user) {
  std::string name = user.name;
  return {std::move(name), std::move(user)};
}
inline Change<Session> put(Session session) {
  std::string key = session.key;
  return {std::move(key), std::move(session)};
}
inline Change<Token> put(Token token) {
  std::string name = token.name;
  return {std::move(name), std::move(token)};
}

inline User user_of(const std::string& name, UserRole role = UserRole::viewer, bool disabled = false) {
  return {name, role, "hash of " + name, disabled, {1'800'000'000'000'000'001}, Bytes("st\0mp", 5)};
}

inline Bytes chain_start() {
  return audit_start("fleet", "cloud");
}

/// That many records in a row of "ann" and "bob" in turn.
inline std::vector<AuditRow> records(AuditChain& chain, int count) {
  std::vector<AuditRow> out;
  for (int i = 0; i < count; ++i) {
    const std::string who = chain.number() % 2 == 0 ? "ann" : "bob";
    out.push_back(chain.append({0, 5, who, "10.0.0.1", "POST /api/v1/runs", "run-1", "done"}));
  }
  return out;
}

inline StoreBatch audit_batch(std::vector<AuditRow> rows) {
  StoreBatch out;
  out.audit = std::move(rows);
  return out;
}

}  // namespace trb::gateway::test

// A test that both stores have to pass, each as a test of its own.
#define TRB_STORE_TEST_(body, name)              \
  static void body();                            \
  TEST_CASE(name " (SQLite)") {                  \
    trb::gateway::test::with_store(false, body); \
  }                                              \
  TEST_CASE(name " (PostgreSQL)") {              \
    trb::gateway::test::with_store(true, body);  \
  }                                              \
  static void body()
#define BOTH_STORES(name) TRB_STORE_TEST_(DOCTEST_ANONYMOUS(store_test_), name)
