// Inviter and joiner against each other: every way in which a code is used, and misused.
#include <doctest/doctest.h>

#include "common/operator/inviter.hpp"
#include "common/operator/joiner.hpp"
#include "proto/body.hpp"

using namespace trb;
using namespace trb::op;

namespace {

using Received = Inviter::Received;

/// What the new node's request is.
SignedRecord request_of(const std::string& id, Role role = Role::robot) {
  const SigningKey identity = make_signing_key();
  const CertificateRequest request{id, role, {identity.public_key}, {make_link_key().public_key}};
  return sign(kSignedRequest, id, {}, encode(request), identity);
}

/// A computer with the code. `folder`: the node that its folder is.
struct NewNode {
  SignedRecord request;
  std::string folder;
  Status disk = Done{};
  std::size_t taken = 0;
  Joiner joiner;

  explicit NewNode(const InvitationKeys& keys, const std::string& id = "arm")
      : request(request_of(id)),
        folder(id),
        joiner(
            keys,
            [this](const JoinOffer& invited) {
              return invited.name == folder ? Result<SignedRecord>(request)
                                            : fail(Errc::conflict, "this folder is '" + folder + "'");
            },
            [this](const JoinOffer&) {
              if (disk) ++taken;
              return disk;
            }) {}
};

struct Hall {
  InvitationKeys keys = (init_crypto(), invitation_keys("the secret"));
  std::size_t signatures = 0;
  Status authority = Done{};
  Inviter inviter{keys, open(), [this](const SignedRecord&) { return sign_it(); }};

  static JoinOffer open() {
    JoinOffer offer;
    offer.name = "arm";
    offer.fleet = "hall";
    return offer;
  }
  Result<JoinOffer> sign_it() {
    if (!authority) return authority.error();
    ++signatures;
    JoinOffer offer = open();
    offer.certificate.kind = kSignedCertificate;
    return offer;
  }
};

}  // namespace

TEST_CASE("a node asks, its request is signed once, it says that it has the certificate") {
  Hall hall;
  NewNode node(hall.keys);
  CHECK(node.joiner.message().empty());
  REQUIRE(node.joiner.receive(hall.inviter.offer()));
  CHECK(node.joiner.is_invited());
  CHECK(hall.inviter.receive(node.joiner.message()) == Received::signed_one);
  CHECK(hall.inviter.number() == 2);
  REQUIRE(node.joiner.receive(hall.inviter.offer()));
  CHECK(node.joiner.has_joined());
  CHECK(node.joiner.offer().certificate.kind == kSignedCertificate);
  CHECK_FALSE(node.joiner.is_over());
  CHECK(hall.inviter.receive(node.joiner.message()) == Received::done);
  REQUIRE(node.joiner.receive(hall.inviter.offer()));
  CHECK(node.joiner.is_over());
  CHECK((hall.signatures == 1 && node.taken == 1));
}

TEST_CASE("two computers with one code: one joins, the other is told, and so is the inviter") {
  Hall hall;
  NewNode first(hall.keys);
  NewNode second(hall.keys);
  REQUIRE(first.joiner.receive(hall.inviter.offer()));
  REQUIRE(second.joiner.receive(hall.inviter.offer()));
  CHECK(hall.inviter.receive(second.joiner.message()) == Received::signed_one);
  CHECK(hall.inviter.receive(first.joiner.message()) == Received::second);
  CHECK(hall.inviter.receive(first.joiner.message()) == Received::nothing);
  CHECK(first.joiner.receive(hall.inviter.offer()).error().code == Errc::already_claimed);
  CHECK(second.joiner.receive(hall.inviter.offer()).ok());
  CHECK(hall.signatures == 1);
  CHECK(first.taken == 0);
}

TEST_CASE("a code that was used signs nothing more, for its own node neither: killed before the disk, it asks again") {
  Hall hall;
  NewNode node(hall.keys);
  REQUIRE(node.joiner.receive(hall.inviter.offer()));
  REQUIRE(hall.inviter.receive(node.joiner.message()) == Received::signed_one);
  // Killed, started again with the same keys: another word, the same request, the same certificate.
  NewNode again(hall.keys);
  again.request = node.request;
  REQUIRE(again.joiner.receive(hall.inviter.offer()));
  CHECK(again.joiner.has_joined());
  CHECK(hall.signatures == 1);
}

TEST_CASE("words that are replayed, changed, of another code, or rubbish change nothing") {
  Hall hall;
  NewNode node(hall.keys);
  REQUIRE(node.joiner.receive(hall.inviter.offer()));
  const InvitationKeys others = invitation_keys("another secret");
  NewNode stranger(others);
  const Bytes foreign = lock_join(others.to_inviter, encode(JoinWord{stranger.request, false}));
  CHECK(hall.inviter.receive(foreign) == Received::nothing);
  CHECK(hall.inviter.receive("rubbish") == Received::nothing);
  CHECK(hall.inviter.receive(lock_join(hall.keys.to_inviter, "no word")) == Received::nothing);
  CHECK(hall.inviter.receive(hall.inviter.offer()) == Received::nothing);  // reflected
  Bytes changed = node.joiner.message();
  changed[30] = static_cast<char>(changed[30] ^ 4);
  CHECK(hall.inviter.receive(changed) == Received::nothing);
  CHECK(hall.signatures == 0);
  CHECK(hall.inviter.receive(node.joiner.message()) == Received::signed_one);
  CHECK(hall.inviter.receive(node.joiner.message()) == Received::nothing);
  CHECK(hall.signatures == 1);
}

TEST_CASE("a cloud node that invents, changes or reflects offers can only make the node wait") {
  Hall hall;
  NewNode node(hall.keys);
  const Bytes first = hall.inviter.offer();
  REQUIRE(node.joiner.receive("").ok());
  REQUIRE(node.joiner.receive("rubbish").ok());
  REQUIRE(node.joiner.receive(lock_join(Bytes(32, 'x'), encode(Hall::open()))).ok());
  CHECK_FALSE(node.joiner.is_invited());
  REQUIRE(node.joiner.receive(first).ok());
  REQUIRE(node.joiner.receive(node.joiner.message()).ok());
  REQUIRE(node.joiner.receive(first).ok());
  CHECK_FALSE(node.joiner.has_joined());
  REQUIRE(hall.inviter.receive(node.joiner.message()) == Received::signed_one);
  Bytes changed = hall.inviter.offer();
  changed.back() = static_cast<char>(changed.back() ^ 1);
  REQUIRE(node.joiner.receive(changed).ok());
  CHECK_FALSE(node.joiner.has_joined());
  REQUIRE(node.joiner.receive(hall.inviter.offer()).ok());
  CHECK(node.joiner.has_joined());
}

TEST_CASE("a folder that is another node's asks nothing; a request for another name is not signed, and costs no code") {
  Hall hall;
  NewNode other(hall.keys, "belt");
  CHECK(other.joiner.receive(hall.inviter.offer()).error().code == Errc::conflict);
  CHECK(other.joiner.message().empty());

  const Bytes lie = lock_join(hall.keys.to_inviter, encode(JoinWord{request_of("belt"), false}));
  CHECK(hall.inviter.receive(lie) == Received::refused);
  CHECK(hall.inviter.refusal().find("belt") != std::string::npos);
  const Bytes cloud = lock_join(hall.keys.to_inviter, encode(JoinWord{request_of("arm", Role::cloud), false}));
  CHECK(hall.inviter.receive(cloud) == Received::refused);
  NewNode node(hall.keys);
  REQUIRE(node.joiner.receive(hall.inviter.offer()).ok());  // a refusal of somebody else's
  CHECK(hall.inviter.receive(node.joiner.message()) == Received::signed_one);
  CHECK(node.joiner.receive(hall.inviter.offer()).ok());
  CHECK(node.joiner.has_joined());
}

TEST_CASE("what the authority refuses is told to the node; put right, the same code is good") {
  Hall hall;
  hall.authority = fail(Errc::conflict, "'arm' has other keys", "trb fleet revoke");
  NewNode node(hall.keys);
  REQUIRE(node.joiner.receive(hall.inviter.offer()));
  CHECK(hall.inviter.receive(node.joiner.message()) == Received::refused);
  const Status told = node.joiner.receive(hall.inviter.offer());
  REQUIRE_FALSE(told.ok());
  CHECK(told.error().what.find("has other keys") != std::string::npos);
  const Bytes old = hall.inviter.offer();

  // Tried again as it is: the mailbox still holds the old answer, which is none; the new one is told.
  NewNode still(hall.keys);
  still.request = node.request;
  REQUIRE(still.joiner.receive(old).ok());
  REQUIRE(still.joiner.receive(old).ok());
  CHECK(hall.inviter.receive(still.joiner.message()) == Received::refused);
  CHECK(still.joiner.receive(hall.inviter.offer()).error().code == Errc::not_permitted);

  hall.authority = Done{};
  NewNode again(hall.keys);
  again.request = node.request;
  REQUIRE(again.joiner.receive(hall.inviter.offer()).ok());
  CHECK(again.joiner.is_invited());
  CHECK(hall.inviter.receive(again.joiner.message()) == Received::signed_one);
  REQUIRE(again.joiner.receive(hall.inviter.offer()).ok());
  CHECK(again.joiner.has_joined());
}

TEST_CASE("a node that cannot write its certificate says so, and is not done") {
  Hall hall;
  NewNode node(hall.keys);
  REQUIRE(node.joiner.receive(hall.inviter.offer()));
  REQUIRE(hall.inviter.receive(node.joiner.message()) == Received::signed_one);
  node.disk = fail(Errc::io_error, "disk full");
  CHECK(node.joiner.receive(hall.inviter.offer()).error().code == Errc::io_error);
  CHECK_FALSE(node.joiner.has_joined());
  node.disk = Done{};
  CHECK(node.joiner.receive(hall.inviter.offer()).ok());
  CHECK(node.joiner.has_joined());
}
