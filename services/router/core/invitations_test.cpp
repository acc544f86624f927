// Invitations by themselves, and a core whose door answers to a code.
#include "services/router/core/invitations.hpp"

#include "services/router/test/test_fleet.hpp"
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
  Budget checks{kInvitationsOfOne};
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
    return hold(record, number, offer, over);
  }
  Result<InvitationState> hold(const SignedRecord& of, std::uint64_t number = 1, const Bytes& offer = "offer",
                               bool over = false) {
    return invitations.hold({of, number, {offer}, over}, checks, now, out);
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
  const auto refused = [&](const SignedRecord& record) { return door.hold(record).error().code; };
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
  CHECK(robot.hold({door.record, 1, {"offer"}, false}, door.checks, door.now, door.out).error().code ==
        Errc::not_permitted);
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
    CHECK(door.hold(another).ok());
    if (i % 8 == 0) door.pass(std::chrono::seconds(1));
  }
  door.pass(std::chrono::seconds(1));
  const SignedRecord more = door.invite(invitation_keys("more"));
  CHECK(door.hold(more).error().code == Errc::queue_full);
}

TEST_CASE("given sixteen codes that were used, then the oldest makes room for one more; an open one never does") {
  Door door;
  const auto keys_of = [](std::size_t i) { return invitation_keys("used " + std::to_string(i)); };
  const auto is_open = [&](std::size_t i) { return door.invitations.is_invited(keys_of(i).caller.public_key); };
  REQUIRE(door.hold());
  for (std::size_t i = 1; i < kMaxInvitations; ++i) {
    const SignedRecord used = door.invite(keys_of(i));
    REQUIRE(door.hold(used));
    REQUIRE(door.hold(used, 2, "certificate", true));
    door.pass(std::chrono::seconds(1));
  }
  CHECK(door.hold(door.invite(keys_of(kMaxInvitations))).ok());
  CHECK(door.is_open());
  CHECK_FALSE(is_open(1));
  CHECK(is_open(2));
}

TEST_CASE("given a member that brings forged invitations without end, then few signatures are checked, all its own") {
  Door door;
  std::size_t checked = 0;
  for (int i = 1; i <= 100; ++i) {
    SignedRecord forged = door.record;
    forged.signature.bytes[1] = static_cast<char>(forged.signature.bytes[1] ^ i);  // never the real one
    if (door.hold(forged).error().code == Errc::bad_signature) ++checked;
  }
  CHECK(checked == kInvitationsOfOne);
  CHECK(door.hold().error().code == Errc::queue_full);
  Budget another{kInvitationsOfOne};
  const SignedRecord good = door.invite(invitation_keys("another member's"));
  CHECK(door.invitations.hold({good, 1, {"offer"}, false}, another, door.now, door.out).ok());
  CHECK(door.invitations.hold_own({door.record, 1, {"offer"}, false}, door.now, door.out).ok());
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

TEST_CASE("given a member that spends all its checks, then another member's invitation is answered") {
  TestFleet fleet;
  TestNode& cloud = fleet.start("cloud", {.role = Role::cloud});
  TestNode& bee = fleet.start("bee");
  TestNode& cat = fleet.start("cat");
  fleet.run(std::chrono::seconds(3));
  const auto send = [&](TestNode& from, const std::string& code) {
    const InvitationKeys keys = invitation_keys(code);
    const Invitation invitation{{fleet.authority.fleet.id()},
                                "arm",
                                Role::robot,
                                {keys.caller.public_key},
                                (fleet.now.utc + kInvitationTime).ns};
    HoldInvitation order{sign_invitation(invitation, fleet.authority.key), 1, {"offer"}, false};
    if (&from == &bee) order.invitation.signature.bytes = Bytes(64, 'x');
    Effects effects;
    effects.add(LinkSend{from.link_to("cloud"), make_message(MessageType::request, from.id, "cloud", order)});
    fleet.carry_out(from, effects);
  };
  for (int i = 0; i < 40; ++i) send(bee, "forged " + std::to_string(i));
  send(cat, "good");
  fleet.run(2 * kStep);
  CHECK(cloud.count("refused.bad_signature") == kInvitationsOfOne);
  CHECK(cloud.count("invitations.held") == 1);
}
