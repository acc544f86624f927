// The inviter's side of an invitation: which of the requests that come is signed, once, and what is answered.
#pragma once

#include <functional>
#include <set>
#include <string>

#include "common/security/invitation.hpp"

namespace trb::op {

/// so far       | a message comes                            | next
/// -------------|--------------------------------------------|-----------------------------------------------------
/// any          | not locked with the code, or seen before   | as before
/// open         | a request for the name and role            | signed: the offer has the certificate
/// open         | a request for another, or one not signed   | open: the offer says why
/// signed       | the same node's request                    | signed
/// signed       | the same node: done                        | done
/// signed, done | another node's request                     | as before: `second`, somebody else has the code
class Inviter {
 public:
  /// Signs the request and returns the offer with its certificate.
  using Sign = std::function<Result<JoinOffer>(const SignedRecord& request)>;
  enum class Received : unsigned char { nothing, refused, signed_one, second, done };

  /// `open`: what a node with the code learns before it has asked: name, role, fleet.
  Inviter(InvitationKeys keys, JoinOffer open, Sign sign);

  Received receive(BytesView message);

  /// Of the newest offer; it begins with 1.
  [[nodiscard]] std::uint64_t number() const { return number_; }
  /// Locked with the code.
  [[nodiscard]] const Bytes& offer() const { return offer_; }
  [[nodiscard]] bool has_signed() const { return !chosen_.empty(); }
  /// The identity key of the node whose request was signed; 32 bytes.
  [[nodiscard]] const Bytes& identity() const { return identity_; }
  /// Why the last request was refused.
  [[nodiscard]] const std::string& refusal() const { return refusal_; }

 private:
  void answer(JoinOffer offer);
  Received on_request(const SignedRecord& request, const Bytes& digest);
  Received refuse(const Bytes& digest, const std::string& why);

  InvitationKeys keys_;
  JoinOffer open_;
  Sign sign_;
  std::set<Bytes> seen_;
  std::uint64_t number_ = 0;
  Bytes offer_;
  Bytes chosen_;
  Bytes identity_;
  std::string refusal_;
};

}  // namespace trb::op
