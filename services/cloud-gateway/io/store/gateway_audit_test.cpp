// The audit log in the store: appended to only, read in pages.
#include <sqlite3.h>

#include <limits>

#include "common/audit/audit_verify.hpp"
#include "services/cloud-gateway/io/store/test/store_folder.hpp"

using namespace trb;
using namespace trb::gateway;
using namespace trb::gateway::test;

namespace {

/// What the database says to a statement of somebody else's; empty: it was done.
std::string said(const StoreFolder& folder, const char* sql) {
  if (postgres_turn() != nullptr) return postgres_turn()->said(sql);
  sqlite3* db = nullptr;
  REQUIRE(sqlite3_open(folder.file().c_str(), &db) == SQLITE_OK);
  const int code = sqlite3_exec(db, sql, nullptr, nullptr, nullptr);
  const std::string out = code == SQLITE_OK ? "" : sqlite3_errmsg(db);
  sqlite3_close(db);
  return out;
}

struct AuditStore {
  explicit AuditStore(int count) { REQUIRE(db->save(audit_batch(records(chain, count)))); }
  std::vector<std::uint64_t> numbers(const AuditQuery& query) const {
    const auto rows = db->audit(query);
    REQUIRE(rows.ok());
    std::vector<std::uint64_t> out;
    for (const AuditRow& row : *rows) out.push_back(row.record.number);
    return out;
  }

  StoreFolder folder;
  std::unique_ptr<GatewayDb> db = opened(folder);
  AuditChain chain{chain_start()};
};

using Numbers = std::vector<std::uint64_t>;
constexpr std::uint64_t kHighestNumber = std::numeric_limits<std::uint64_t>::max();

}  // namespace

BOTH_STORES("the chain goes on after a restart, and verifies as it is stored") {
  AuditStore store(3);
  const StoredState state = loaded(*opened(store.folder));
  AuditChain later(chain_start(), *state.last_audit);
  REQUIRE(store.db->save(audit_batch(records(later, 2))));
  const auto rows = *store.db->audit_from(1, 100);
  const AuditReport report = verify_audit(chain_start(), rows, {});
  CHECK_FALSE(report.fault);
  CHECK(report.good == 5);
}

BOTH_STORES("a page has the newest first, below a number, of one person") {
  AuditStore store(7);  // ann: 1 3 5 7, bob: 2 4 6
  CHECK(store.numbers({}) == Numbers{7, 6, 5, 4, 3, 2, 1});
  CHECK(store.numbers({std::nullopt, 2, ""}) == Numbers{7, 6});
  CHECK(store.numbers({6, 2, ""}) == Numbers{5, 4});
  CHECK(store.numbers({std::nullopt, 10, "bob"}) == Numbers{6, 4, 2});
  CHECK(store.numbers({6, 1, "bob"}) == Numbers{4});
  CHECK(store.numbers({2, 10, "bob"}).empty());
  CHECK(store.numbers({1, 10, ""}).empty());
  CHECK(store.numbers({0, 10, ""}).empty());
  CHECK(store.numbers({kHighestNumber, 10, "ann"}) == Numbers{7, 5, 3, 1});
  CHECK(store.numbers({std::nullopt, 10, "nobody"}).empty());
}

BOTH_STORES("a page has 1 to 1000 records") {
  AuditStore store(1001);
  CHECK(store.numbers({std::nullopt, 1000, ""}).size() == 1000);
  CHECK(store.numbers({}).size() == 100);
  for (const std::size_t most : {std::size_t{0}, std::size_t{1001}, std::numeric_limits<std::size_t>::max()}) {
    const auto rows = store.db->audit({std::nullopt, most, ""});
    REQUIRE_FALSE(rows.ok());
    CHECK(rows.error().code == Errc::bad_value);
    CHECK(rows.error().hint == "use a number from 1 to 1000");
  }
}

BOTH_STORES("for a check of the chain the rows come from a number on, in order") {
  AuditStore store(5);
  CHECK(store.db->audit_from(1, 2)->back().record.number == 2);
  CHECK(store.db->audit_from(4, 100)->front().record.number == 4);
  CHECK(store.db->audit_from(4, std::numeric_limits<std::size_t>::max())->size() == 2);
  CHECK(store.db->audit_from(6, 100)->empty());
  CHECK(store.db->audit_from(kHighestNumber, 100)->empty());
}

BOTH_STORES("a record that does not follow the last one is refused: two gateways share the store") {
  AuditStore store(2);
  const auto two = opened(store.folder);
  AuditChain behind(chain_start());
  records(behind, 1);
  const Error twice = refused(*two, audit_batch(records(behind, 1)));
  CHECK(twice.code == Errc::conflict);
  CHECK(twice.what.find("audit record 2") != std::string::npos);
  CHECK(twice.hint.find("another gateway") != std::string::npos);
  records(store.chain, 1);  // never stored: a gap
  CHECK(refused(*store.db, audit_batch(records(store.chain, 1))).code == Errc::conflict);
  CHECK(store.numbers({}) == Numbers{2, 1});
}

BOTH_STORES("records and heads are never changed, replaced or removed") {
  AuditStore store(3);
  StoreBatch batch;
  batch.heads = {{2, "signed"}};
  REQUIRE(store.db->save(batch));
  const auto rows = *store.db->audit_from(1, 100);
  CHECK(said(store.folder, "UPDATE audit SET who = address WHERE number = 2") == "audit records are never changed");
  CHECK(said(store.folder, "DELETE FROM audit WHERE number = 3") == "audit records are never removed");
  CHECK(said(store.folder, "DELETE FROM audit") == "audit records are never removed");
  CHECK(said(store.folder,
             "INSERT INTO audit SELECT 3, time, address, address, action, about, outcome, hash FROM audit "
             "WHERE number = 3 ON CONFLICT(number) DO UPDATE SET who = excluded.who") ==
        "the audit record does not follow the last one");
  CHECK(said(store.folder, "UPDATE heads SET record = NULL") == "signed heads are never changed");
  CHECK(said(store.folder, "DELETE FROM heads") == "signed heads are never removed");
  if (postgres_turn() == nullptr) {
    CHECK(said(store.folder, "INSERT OR REPLACE INTO heads VALUES(2, x'00')").empty());
  } else {
    CHECK(said(store.folder, "TRUNCATE audit") == "audit records are never removed");
    CHECK(said(store.folder, "TRUNCATE heads") == "signed heads are never removed");
  }
  CHECK(*store.db->audit_from(1, 100) == rows);
  CHECK(*store.db->heads(0, 1000) == std::vector<SignedHead>{{2, "signed"}});
}

BOTH_STORES("a head that comes twice is kept once, and heads come by number") {
  AuditStore store(9);
  StoreBatch batch;
  batch.heads = {{9, "nine"}, {4, "four"}, {4, "four, signed again"}};
  REQUIRE(store.db->save(batch));
  REQUIRE(store.db->save(batch));
  CHECK(*store.db->heads(0, 1000) == std::vector<SignedHead>{{4, "four"}, {9, "nine"}});
  CHECK(*store.db->heads(5, 9) == std::vector<SignedHead>{{9, "nine"}});
  CHECK(store.db->heads(5, 8)->empty());
  CHECK(loaded(*store.db).signed_to == 9);
}
