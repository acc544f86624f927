// What a person types as a code, and what whoever has the code writes to the inviter.
#include "common/security/join_code.hpp"
#include "common/operator/inviter.hpp"
#include "common/operator/joiner.hpp"
#include "proto/body.hpp"
#include "tests/fuzz/target.hpp"

namespace trb::fuzz {
namespace {

JoinCode a_code() {
  return {Bytes(kJoinSecret, 's'), Role::robot, Bytes(32, 'k'), "10.0.0.1:45000"};
}

SignedRecord a_request() {
  init_crypto();
  static const SigningKey key = make_signing_key();
  const CertificateRequest request{"arm", Role::robot, {key.public_key}, {Bytes(32, 'l')}};
  return sign(kSignedRequest, "arm", {}, encode(request), key);
}

void typed(BytesView input) {
  const auto code = read_join_code(input);
  if (!code) return;
  const auto text = to_text(*code);
  require(text && *read_join_code(*text) == *code, "a code that is read is the one that is written");
}

/// Locked as by whoever has the code.
void heard(BytesView input) {
  const InvitationKeys keys = invitation_keys("secret");
  JoinOffer open;
  open.name = "arm";
  int signatures = 0;
  op::Inviter inviter(keys, open, [&](const SignedRecord&) {
    ++signatures;
    return Result<JoinOffer>(open);
  });
  (void)inviter.receive(input);
  require(signatures == 0, "what is not locked with the code is not heard");
  (void)inviter.receive(lock_join(keys.to_inviter, input));
  (void)inviter.receive(lock_join(keys.to_inviter, encode(JoinWord{a_request(), false})));
  (void)inviter.receive(lock_join(keys.to_inviter, input));
  require(signatures == 1, "one request is signed");
  op::Joiner joiner(
      keys, [](const JoinOffer&) { return Result<SignedRecord>(a_request()); },
      [](const JoinOffer&) { return Status(Done{}); });
  (void)joiner.receive(input);
  require(!joiner.is_invited(), "what is not locked with the code invites nobody");
  (void)joiner.receive(lock_join(keys.to_node, input));
  (void)joiner.receive(lock_join(keys.to_node, input));
}

}  // namespace

std::vector<Bytes> seeds() {
  init_crypto();
  JoinCode v6 = a_code();
  v6.door = "[fd00::1]:45000";
  JoinOffer offer;
  offer.name = "arm";
  offer.request = {digest_of_request(a_request())};
  offer.certificate = a_request();
  offer.seeds = {{"10.0.0.1:45000", {Bytes(32, 'k')}}};
  return {*to_text(a_code()), *to_text(v6), encode(JoinWord{a_request(), false}), encode(JoinWord{a_request(), true}),
          encode(offer)};
}

void run(BytesView input) {
  init_crypto();
  typed(input);
  heard(input);
}

}  // namespace trb::fuzz
