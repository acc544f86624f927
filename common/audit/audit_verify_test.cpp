// Somebody has the store and changes it; a third party has the signed heads.
#include "common/audit/audit_verify.hpp"

#include <doctest/doctest.h>

#include "common/security/keys.hpp"
#include "proto/field.hpp"

using namespace trb;
using namespace trb;

namespace {

constexpr std::int64_t kRestored = 1'800'000'000'000'000'000;  ///< UTC ns

struct Store {
  Bytes start = audit_start(Bytes(16, 'f'), "cloud");
  std::vector<AuditRow> rows;
  std::vector<AuditHead> heads;

  /// Ten records; signed heads at the fourth and the eighth.
  Store() {
    AuditChain chain(start);
    for (int i = 1; i <= 10; ++i) {
      rows.push_back(chain.append({0, i, "ann", "10.0.0.7", "POST /api/v1/stop", "arm-" + std::to_string(i), "done"}));
      if (i % 4 == 0) heads.push_back(chain.head({i}));
    }
  }
  [[nodiscard]] AuditReport report() const { return verify_audit(start, rows, heads); }
  /// What was found, as "kind number".
  [[nodiscard]] std::string fault() const {
    const auto found = report().fault;
    return found ? std::string(name_of(found->kind)) + " " + std::to_string(found->number) : "none";
  }
  /// As an attacker does who knows how the chain is made.
  void hash_anew() {
    Bytes hash = start;
    for (std::size_t i = 0; i < rows.size(); ++i) {
      rows[i].record.number = i + 1;
      hash = rows[i].hash = audit_hash(hash, rows[i].record);
    }
  }
};

}  // namespace

TEST_CASE("given nobody has touched it, then all fits, and what came after the last head is told apart") {
  const Store store;
  CHECK(store.fault() == "none");
  CHECK(store.report().good == 10);
  CHECK(store.report().covered == 8);
  CHECK_FALSE(verify_audit(store.start, {}, {}).fault);
}

TEST_CASE("given a record was altered in any of its fields, then it is named") {
  const std::array<void (*)(AuditRecord&), 7> changes{[](AuditRecord& r) { r.time += 1; },
                                                      [](AuditRecord& r) { r.who = "bob"; },
                                                      [](AuditRecord& r) { r.from = "10.0.0.8"; },
                                                      [](AuditRecord& r) { r.action = "GET /"; },
                                                      [](AuditRecord& r) { r.about.clear(); },
                                                      [](AuditRecord& r) { r.outcome = "role_too_low"; },
                                                      [](AuditRecord& r) { r.about += std::string(300, 'x'); }};
  for (const auto& change : changes) {
    Store store;
    change(store.rows[4].record);
    CHECK(store.fault() == "altered 5");
    CHECK(store.report().good == 4);
  }
}

TEST_CASE("given a text was lengthened behind its bound, where the msgpack is cut, then that is found too") {
  Store store;
  AuditChain chain(store.start);
  AuditRecord record = store.rows[0].record;
  record.who = std::string(80, 'a');
  store.rows = {chain.append(record)};
  store.heads.clear();
  CHECK(store.fault() == "none");
  store.rows[0].record.who += "nother";
  CHECK(store.fault() == "altered 1");
}

TEST_CASE("given a hash was altered, then its record is named") {
  Store store;
  store.rows[6].hash[0] = static_cast<char>(store.rows[6].hash[0] ^ 1);
  CHECK(store.fault() == "altered 7");
}

TEST_CASE("given a record was taken out of the middle, or from the beginning, then the missing one is named") {
  Store store;
  store.rows.erase(store.rows.begin() + 4);
  CHECK(store.fault() == "missing 5");
  Store beheaded;
  beheaded.rows.erase(beheaded.rows.begin(), beheaded.rows.begin() + 3);
  CHECK(beheaded.fault() == "missing 1");
}

TEST_CASE(
    "given two records changed places, then the first of them is named; also when they took each other's numbers") {
  Store store;
  std::swap(store.rows[4], store.rows[5]);
  CHECK(store.fault() == "missing 5");
  std::swap(store.rows[4].record.number, store.rows[5].record.number);
  CHECK(store.fault() == "altered 5");
}

TEST_CASE("given a record was put in, then the place is named, whatever number it bears") {
  Store store;
  store.rows.insert(store.rows.begin() + 4, store.rows[3]);
  CHECK(store.fault() == "out_of_order 5");
  store.rows[4].record.number = 5;
  CHECK(store.fault() == "altered 5");
}

TEST_CASE("given the end was cut off behind a signed head, then the first that is gone is named") {
  Store store;
  store.rows.resize(7);
  CHECK(store.fault() == "truncated 8");
  store.rows.clear();
  CHECK(store.fault() == "truncated 1");
}

TEST_CASE("given what was not signed yet was cut off, then the heads cannot tell: a minute is at stake") {
  Store store;
  store.rows.resize(8);
  CHECK(store.fault() == "none");
}

TEST_CASE("given a record was altered, taken out or put in, and all hashed anew, then the signed heads tell") {
  Store altered;
  altered.rows[5].record.who = "bob";
  altered.hash_anew();
  CHECK(altered.fault() == "other_head 5");  // between the heads at 4 and 8
  CHECK(altered.report().good == 4);
  Store removed;
  removed.rows.erase(removed.rows.begin());
  removed.hash_anew();
  CHECK(removed.fault() == "other_head 1");
  Store inserted;
  inserted.rows.insert(inserted.rows.begin() + 6, inserted.rows[0]);
  inserted.hash_anew();
  CHECK(inserted.fault() == "other_head 5");
}

TEST_CASE("given rows of another node, or its heads, then they do not fit") {
  Store store;
  store.start = audit_start(Bytes(16, 'f'), "other");
  CHECK(store.fault() == "other_chain 1");
  store.heads.clear();
  CHECK(store.fault() == "altered 1");
}

TEST_CASE("heads come in any order, and twice") {
  Store store;
  std::swap(store.heads[0], store.heads[1]);
  store.heads.push_back(store.heads[0]);
  CHECK(store.fault() == "none");
  CHECK(store.report().covered == 8);
}

TEST_CASE("given a head over no record, then it fits the beginning and nothing else") {
  Store store;
  store.heads = {AuditChain(store.start).head({1})};
  CHECK(store.fault() == "none");
  store.heads[0].hash.bytes[3] = 'x';
  CHECK(store.fault() == "other_head 1");
}

TEST_CASE("a third party with the public key alone: the node's signature over a head is checked, then the rows") {
  init_crypto();
  const Store store;
  const SigningKey node = make_signing_key();
  const Bytes fleet(16, 'f');
  SignedRecord record = sign(kSignedAuditHead, "cloud", fleet, audit_head_payload(store.heads.back()), node);
  REQUIRE(verify(record, kSignedAuditHead, fleet, node.public_key));
  const std::array<AuditHead, 1> heads{*read_audit_head(record.payload.bytes)};
  CHECK(verify_audit(store.start, store.rows, heads).covered == 8);
  record.payload.bytes.back() = static_cast<char>(record.payload.bytes.back() ^ 1);
  CHECK_FALSE(verify(record, kSignedAuditHead, fleet, node.public_key));
}

TEST_CASE("given the store was brought back from a backup, then its log goes on with numbers that were never given") {
  Store store;
  AuditChain chain(store.start, store.rows.back());
  store.rows.push_back(chain.append({0, kRestored, "console", "", std::string(kAuditRestored), "", "done"}));
  store.rows.push_back(chain.append({0, 12, "ann", "10.0.0.7", "POST /api/v1/stop", "arm", "done"}));
  store.heads.push_back(chain.head({12}));
  CHECK(store.rows[10].record.number == 1'800'000'000'000);
  CHECK(store.fault() == "none");
  CHECK(store.report().good == 1'800'000'000'001);
  CHECK(store.report().covered == 1'800'000'000'001);
  REQUIRE(store.report().restored.size() == 1);
  CHECK(store.report().restored[0].number == 1'800'000'000'000);

  store.rows[10].record.number = 11;
  CHECK(store.fault() == "out_of_order 1800000000000");
}

TEST_CASE(
    "given somebody takes records out and says that a backup was brought back, then a signed head says otherwise") {
  Store store;
  store.rows.resize(6);
  AuditChain chain(store.start, store.rows.back());
  store.rows.push_back(chain.append({0, kRestored, "console", "", std::string(kAuditRestored), "", "done"}));
  CHECK(store.fault() == "missing 7");
}
