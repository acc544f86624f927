// Invitations by themselves, and a core whose door answers to a code.
#include "services/router/core/invitations.hpp"

#include "services/router/test/test_parts.hpp"

using namespace trb;
using namespace trb::router;

namespace {

/// "ant" as a cloud node, the inviter's invitation, and the keys of its code.
struct Door : Parts {
  InvitationKeys keys = invitation_keys("a secret of this test");
  LocalNode cloud{as_cloud()};
  Admission admission{cloud, table, trust};
  Invitations invitations{cloud, admission};
  SignedRecord record = invite(keys);

  RouterConfig as_cloud() const {
    RouterConfig config = this->config();
    config.role = Role::cloud;
    return config;
  }
  SignedRecord invite(const InvitationKeys& of, Duration time = kInvitationTime) const {
    return sign_invitation({{authority.fleet.id()}, "cat", Role::robot, {of.caller.public_key}, (now.utc + time).ns},
                           authority.key);
  }
  Result<InvitationState> hold(std::uint64_t number = 1, const Bytes& offer = "offer", bool over = false) {
    return invitations.hold({record, number, {offer}, over}, now, out);
  }
  Result<JoinAnswer> call(const Bytes& word = {}) {
    return invitations.call(keys.caller.public_key, JoinCall{{word}}, now, out);
  }
  [[nodiscard]] bool is_open() const { return invitations.is_invited(keys.caller.public_key); }
  void tick() { invitations.tick(now, out); }
};

}  // namespace

TEST_CASE("given an invitation, then its key may connect, calls are answered with the offer, and words are kept") {
  Door door;
  CHECK_FALSE(door.is_open());
  CHECK(door.hold()->words.empty());
  for (std::size_t i = 0; i < kMaxCandidates; ++i)
    (void)door.admission.admit(make_link_key().public_key, door.now, door.out);
  CHECK(door.admission.admit(door.keys.caller.public_key, door.now, door.out));
  CHECK(door.call("one")->offer.bytes == "offer");
  CHECK(door.call("one")->offer.bytes == "offer");
  CHECK(door.call("two")->offer.bytes == "offer");
  const auto state = door.hold(1, "");
  CHECK(state->number == 1);
  CHECK(state->words == std::vector<JoinCall>{{{"one"}}, {{"two"}}});
}

TEST_CASE("given a newer offer, then it is answered; an older one changes nothing") {
  Door door;
  REQUIRE(door.hold(2, "second"));
  CHECK(door.hold(1, "first")->number == 2);
  CHECK(door.call()->offer.bytes == "second");
}

TEST_CASE("given a forged, foreign, ended or too long invitation, then its key stays a stranger's") {
  Door door;
  const TestAuthority other;
  const auto refused = [&](const SignedRecord& record) {
    return door.invitations.hold({record, 1, {"offer"}, false}, door.now, door.out).error().code;
  };
  SignedRecord forged = door.record;
  forged.signature.bytes[0] = static_cast<char>(forged.signature.bytes[0] ^ 1);
  CHECK(refused(forged) == Errc::bad_signature);
  Invitation foreign{{other.fleet.id()}, "cat", Role::robot, {door.keys.caller.public_key}, door.now.utc.ns + 1000};
  CHECK(refused(sign_invitation(foreign, other.key)) == Errc::foreign_fleet);
  CHECK(refused(door.invite(door.keys, Duration{0})) == Errc::expired);
  CHECK(refused(door.invite(door.keys, std::chrono::hours(2))) == Errc::bad_value);
  CHECK_FALSE(door.is_open());
}

TEST_CASE("given a robot's node, then it keeps no invitation") {
  Door door;
  Invitations robot{door.node, door.admission};
  CHECK(robot.hold({door.record, 1, {"offer"}, false}, door.now, door.out).error().code == Errc::not_permitted);
}

TEST_CASE("given an inviter that has gone, then the door closes after fifteen seconds; one that comes again keeps it") {
  Door door;
  REQUIRE(door.hold());
  door.pass(std::chrono::seconds(14));
  REQUIRE(door.hold());
  door.pass(std::chrono::seconds(14));
  door.tick();
  CHECK(door.is_open());
  CHECK(*door.invitations.next_deadline() == door.now.mono + std::chrono::seconds(1));
  door.pass(std::chrono::seconds(1));
  door.tick();
  CHECK_FALSE(door.is_open());
  CHECK(door.hold().ok());
}

TEST_CASE("given ten minutes, then the door closes though its inviter is there, and does not open again") {
  Door door;
  for (int i = 0; i < 60; ++i) {
    REQUIRE(door.hold());
    door.pass(std::chrono::seconds(10));
    door.tick();
  }
  CHECK_FALSE(door.is_open());
  CHECK(door.hold().error().code == Errc::expired);
}

TEST_CASE(
    "given an invitation that is withdrawn, then its key is a stranger's; used, then it answers and keeps nothing") {
  Door unused;
  REQUIRE(unused.hold());
  REQUIRE(unused.hold(0, "", true));
  CHECK_FALSE(unused.is_open());

  Door used;
  REQUIRE(used.hold());
  (void)used.call("word");
  REQUIRE(used.hold(2, "certificate", true));
  used.pass(std::chrono::seconds(60));
  used.tick();
  CHECK(used.call("later")->offer.bytes == "certificate");
  CHECK(used.hold(2, "")->words.empty());
}

TEST_CASE("given many words, calls and invitations, then each is bounded") {
  Door door;
  REQUIRE(door.hold());
  for (std::uint32_t i = 0; i < kJoinCalls; ++i) CHECK(door.call("word " + std::to_string(i)).ok());
  CHECK(door.call().error().code == Errc::queue_full);
  CHECK(door.hold()->words.size() == kMaxJoinBoxes);
  door.pass(std::chrono::seconds(1));
  CHECK(door.call().ok());
  for (std::size_t i = 1; i < kMaxInvitations; ++i) {
    const SignedRecord another = door.invite(invitation_keys(std::to_string(i)));
    CHECK(door.invitations.hold({another, 1, {"offer"}, false}, door.now, door.out).ok());
    if (i % 8 == 0) door.pass(std::chrono::seconds(1));
  }
  door.pass(std::chrono::seconds(1));
  const SignedRecord more = door.invite(invitation_keys("more"));
  CHECK(door.invitations.hold({more, 1, {"offer"}, false}, door.now, door.out).error().code == Errc::queue_full);
}

TEST_CASE("given forged invitations without end, then few signatures are checked in a second") {
  Door door;
  std::size_t checked = 0;
  for (int i = 1; i <= 100; ++i) {
    SignedRecord forged = door.record;
    forged.signature.bytes[1] = static_cast<char>(forged.signature.bytes[1] ^ i);  // never the real one
    const auto answer = door.invitations.hold({forged, 1, {"offer"}, false}, door.now, door.out);
    if (answer.error().code == Errc::bad_signature) ++checked;
  }
  CHECK(checked <= kInvitationsChecked);
}

TEST_CASE("given a core, then a call is a connection's one word; a stranger's call is refused as any other word") {
  TestFleet fleet;
  TestNode& ant = fleet.start("ant");
  const Bytes key = invitation_keys("nobody's").caller.public_key;
  Effects out;
  const Message call = make_message(MessageType::information, "joining", "", JoinCall{{"word"}});
  ant.core->inbox().on_message(9, key, call, 1, fleet.now, out);
  REQUIRE(out.list.size() >= 1);
  const auto* said = std::get_if<RefuseCandidate>(&out.list.back());
  REQUIRE(said != nullptr);
  CHECK(said->message.subtype == Goodbye::kSubtype);
  CHECK_FALSE(ant.core->admission().admit(key, fleet.now, out));
}
