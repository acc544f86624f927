// The trust store by itself: what it keeps of a trust update, and who is a member then.
#include "services/router/core/trust_store.hpp"

#include "services/router/test/test_parts.hpp"

using namespace trb;
using namespace trb::router;

namespace {

struct Store : Parts {
  /// It says that they have ended, so that the next one may lack them.
  [[nodiscard]] SignedRecord list(std::uint64_t number, const std::vector<std::string>& out_of_it,
                                  std::int64_t until = kStartUtc) const {
    RevocationList made;
    made.fleet = {authority.fleet.id()};
    made.number = number;
    made.issued = kStartUtc;
    for (const std::string& id : out_of_it) made.revoked.push_back({1, id, "stolen", kStartUtc, until});
    return sign(kSignedRevocations, "", authority.fleet.id(), encode(made), authority.key);
  }
  /// The same keys, signed again.
  [[nodiscard]] SignedRecord renewed(const TestKeys& keys, std::uint64_t serial) const {
    Certificate certificate = keys.certificate;
    certificate.serial = serial;
    return sign(kSignedCertificate, "", authority.fleet.id(), encode(certificate), authority.key);
  }
};

}  // namespace

TEST_CASE("given a renewed certificate of a peer, then it is kept, its row has it, and an older one is downgraded") {
  Store store;
  store.link_with(store.bee);
  const SignedRecord newer = store.renewed(store.bee, 5);
  TakenUpdate taken = store.trust.take({{}, {newer}}, nullptr, store.now, store.out);
  CHECK(taken.fresh.certificates.size() == 1);
  CHECK_FALSE(taken.own_renewed);
  CHECK(store.table.find("bee")->certificate.serial == 5);
  taken = store.trust.take({{}, {newer}}, nullptr, store.now, store.out);
  CHECK(taken.is_empty());
  CHECK(taken.known);
  taken = store.trust.take({{}, {store.renewed(store.bee, 4)}}, nullptr, store.now, store.out);
  REQUIRE(taken.refusal);
  CHECK(taken.refusal->code == Errc::downgraded);
  store.trust.forget_shown(store.table.find("bee")->certificate);
  CHECK(store.trust.all().certificates.empty());
}

TEST_CASE("given this node's own renewed certificate, then it is this node's from now on, and is to be stored") {
  Store store;
  const SignedRecord newer = store.renewed(store.ant, 5);
  CHECK(store.trust.take({{}, {newer}}, nullptr, store.now, store.out).own_renewed);
  CHECK(store.node.config().own.serial == 5);
  CHECK(store.all<StoreCertificate>().size() == 1);
}

TEST_CASE("given a list that revokes a member, then it is none, its key is refused, and an older list is not taken") {
  Store store;
  REQUIRE(store.trust.open_member(store.bee.record, store.now, store.out));
  store.trust.take({store.list(2, {"bee"}), {}}, nullptr, store.now, store.out);
  const auto member = store.trust.open_member(store.bee.record, store.now, store.out);
  REQUIRE_FALSE(member);
  CHECK(member.error().code == Errc::cert_revoked);
  CHECK_FALSE(store.trust.is_revoked_key(store.bee.link.public_key));
  store.trust.remember_presented(store.bee.record, store.bee.link.public_key);
  CHECK(store.trust.refuse_revoked_key(store.bee.link.public_key, store.now, store.out));
  const TakenUpdate old = store.trust.take({store.list(1, {}), {}}, nullptr, store.now, store.out);
  CHECK(old.must_be_told);
  CHECK(store.trust.list_number() == 2);
  store.trust.take({store.list(3, {}), {}}, nullptr, store.now, store.out);
  store.trust.drop_revoked();
  CHECK_FALSE(store.trust.is_revoked_key(store.bee.link.public_key));
}

TEST_CASE("given a list that lacks who has not ended, then the next start keeps that node out, by whatever clock") {
  Store store;
  const std::int64_t end = kStartUtc + std::chrono::nanoseconds(std::chrono::hours(1)).count();
  store.trust.take({store.list(1, {"bee"}, end), {}}, nullptr, store.now, store.out);
  store.trust.take({store.list(2, {}), {}}, nullptr, store.now, store.out);
  const StoreUpdate stored = store.trust.to_store(store.out);
  REQUIRE(stored.dropped.size() == 1);
  for (const std::int64_t ahead : {0, 2}) {
    const Now then{store.now.mono, store.now.utc + std::chrono::hours(ahead)};
    TrustStore next{store.node, store.table, store.errors};
    next.restore_dropped(stored.dropped);
    next.take(stored.update, nullptr, then, store.out);
    CHECK(next.list_number() == 2);
    CHECK_FALSE(next.open_member(store.bee.record, store.now, store.out));
    CHECK(next.to_store(store.out).dropped == stored.dropped);
    // The next list is the first one that this start has seen come.
    next.take({store.list(3, {}), {}}, nullptr, then, store.out);
    CHECK(next.to_store(store.out).dropped.empty() == (ahead != 0));
  }
}

TEST_CASE(
    "given a revoked certificate, then its key is refused only if a connection has it, and no other member does") {
  Store store;
  store.link_with(store.bee);
  // Somebody had the authority sign bee's link key under the name of "thief", as earlier versions did.
  Certificate stolen = store.bee.certificate;
  stolen.id = "thief";
  const SignedRecord thief =
      sign(kSignedCertificate, "", store.authority.fleet.id(), encode(stolen), store.authority.key);
  const TestKeys dog = store.authority.sign_node("dog");
  store.trust.take({store.list(2, {"thief", "dog"}), {}}, nullptr, store.now, store.out);
  store.trust.remember_presented(thief, dog.link.public_key);
  store.trust.remember_presented(thief, store.bee.link.public_key);
  store.trust.remember_presented(dog.record, store.bee.link.public_key);
  CHECK_FALSE(store.trust.is_revoked_key(store.bee.link.public_key));
  CHECK_FALSE(store.trust.is_revoked_key(dog.link.public_key));
  store.trust.remember_presented(dog.record, dog.link.public_key);
  CHECK(store.trust.is_revoked_key(dog.link.public_key));
}

TEST_CASE("given no signatures left to be checked, then nothing of an update is taken") {
  Store store;
  Budget none{1};
  none.take(store.now.mono);
  const TakenUpdate taken = store.trust.take({{}, {store.renewed(store.bee, 5)}}, &none, store.now, store.out);
  CHECK(taken.is_empty());
  CHECK(taken.refusal->code == Errc::queue_full);
}
