#include "common/operator/invite_node.hpp"

#include "common/operator/joiner.hpp"
#include "common/operator/test/fake_node.hpp"
#include "proto/body.hpp"

using namespace trb;
using namespace trb::op;

namespace {

struct Invite {
  FakeNode node;
  InvitationKeys keys = (init_crypto(), invitation_keys("the secret"));
  std::vector<Inviter::Received> heard;
  std::size_t held = 0;
  std::size_t silent = 0;
  Ending<InviteEnd> ending;
  InvitingPtr inviting;

  Invite() {
    JoinOffer open;
    open.name = "arm";
    inviting = invite_node(
        node.session(),
        InviteNode{.door = "cloud",
                   .invitation = {"invitation", "", {"payload"}, {"signature"}},
                   .inviter = Inviter(keys, open, [open](const SignedRecord&) { return Result<JoinOffer>(open); }),
                   .on_held = [this] { ++held; },
                   .on_received = [this](Inviter::Received word, const Inviter&) { heard.push_back(word); },
                   .on_silent = [this](const Error&) { ++silent; }},
        ending);
  }
  HoldInvitation next() {
    node.pass(kInviterPause);
    return node.take<HoldInvitation>("cloud");
  }
  /// A word as a node that has the code would write it.
  JoinCall word(bool done) const { return {{lock_join(keys.to_inviter, encode(JoinWord{request, done}))}}; }
  SignedRecord request = [] {
    const SigningKey identity = (init_crypto(), make_signing_key());
    return sign(kSignedRequest, "arm", {},
                encode(CertificateRequest{"arm", Role::robot, {identity.public_key}, {make_link_key().public_key}}),
                identity);
  }();
};

}  // namespace

TEST_CASE("the offer goes once, the certificate when a request came, and the end when the node has it") {
  Invite invite;
  const auto first = invite.node.take<HoldInvitation>("cloud");
  CHECK((first.number == 1 && !first.offer.bytes.empty() && !first.over));
  invite.node.answer(InvitationState{1, {}});
  CHECK(invite.held == 1);
  CHECK(invite.next().offer.bytes.empty());
  invite.node.answer(InvitationState{1, {invite.word(false)}});
  CHECK(invite.heard == std::vector{Inviter::Received::signed_one});
  const auto second = invite.next();
  CHECK((second.number == 2 && !second.offer.bytes.empty()));
  invite.node.answer(InvitationState{2, {invite.word(true)}});
  const auto last = invite.node.take<HoldInvitation>("cloud");
  CHECK((last.over && last.number == 2));
  CHECK_FALSE(invite.ending.has_come());
  invite.node.answer(InvitationState{2, {}});
  CHECK(invite.ending.value() == InviteEnd::joined);
}

TEST_CASE("a cloud node that is killed and has forgotten gets it all again; that it is silent is told once") {
  Invite invite;
  invite.node.take<HoldInvitation>("cloud");
  invite.node.answer(InvitationState{1, {}});
  invite.next();
  invite.node.refuse(Errc::peer_unreachable, "not there");
  invite.next();
  invite.node.refuse(Errc::peer_unreachable, "not there");
  CHECK(invite.silent == 1);
  invite.next();
  invite.node.answer(InvitationState{0, {}});
  const auto again = invite.next();
  CHECK((again.number == 1 && !again.offer.bytes.empty()));
}

TEST_CASE("what the first deposit is refused for ends it") {
  Invite invite;
  invite.node.take<HoldInvitation>("cloud");
  invite.node.refuse(Errc::not_permitted, "a robot's node");
  CHECK(invite.ending.error().code == Errc::not_permitted);
  CHECK(invite.held == 0);
  end_inviting(invite.inviting);
  CHECK(invite.node.is_quiet());
}

TEST_CASE("ended by a person before anybody came, the code is withdrawn") {
  Invite invite;
  invite.node.take<HoldInvitation>("cloud");
  invite.node.answer(InvitationState{1, {}});
  end_inviting(invite.inviting);
  const auto last = invite.node.take<HoldInvitation>("cloud");
  CHECK((last.over && last.number == 0));
  invite.node.answer(InvitationState{1, {}});
  CHECK(invite.ending.value() == InviteEnd::unused);
  invite.node.pass(std::chrono::seconds(5));
  CHECK(invite.node.is_quiet());
}

TEST_CASE("a request that waits when a person ends it is not signed any more; of a signed one the end is heard") {
  Invite invite;
  invite.node.take<HoldInvitation>("cloud");
  invite.node.answer(InvitationState{1, {}});
  const auto look = invite.next();
  CHECK_FALSE(look.over);
  end_inviting(invite.inviting);  // while the cloud node is asked
  invite.node.answer(InvitationState{1, {invite.word(false)}});
  const auto last = invite.node.take<HoldInvitation>("cloud");
  CHECK((last.over && last.number == 0));
  invite.node.answer(InvitationState{1, {invite.word(false)}});
  CHECK(invite.heard.empty());
  CHECK(invite.ending.value() == InviteEnd::unused);

  Invite used;
  used.node.take<HoldInvitation>("cloud");
  used.node.answer(InvitationState{1, {used.word(false)}});
  end_inviting(used.inviting);
  used.node.take<HoldInvitation>("cloud");
  used.node.answer(InvitationState{2, {used.word(true)}});
  CHECK(used.ending.value() == InviteEnd::joined);
}

TEST_CASE("after ten minutes it is over: unused, or signed and never confirmed") {
  for (const bool used : {false, true}) {
    Invite invite;
    invite.node.take<HoldInvitation>("cloud");
    invite.node.answer(InvitationState{1, used ? std::vector<JoinCall>{invite.word(false)} : std::vector<JoinCall>{}});
    for (HoldInvitation last = invite.next(); true; last = invite.next()) {
      invite.node.answer(InvitationState{last.number, {}});
      if (last.over) break;
    }
    CHECK(invite.node.now().mono.ns >= std::chrono::nanoseconds(kInvitationTime).count());
    CHECK(invite.ending.value() == (used ? InviteEnd::unconfirmed : InviteEnd::unused));
  }
}
