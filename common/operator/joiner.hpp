// The new node's side of an invitation: what it writes next, and what becomes of each answer.
#pragma once

#include <functional>

#include "common/security/invitation.hpp"

namespace trb::op {

/// so far  | an offer comes                             | next
/// --------|--------------------------------------------|----------------------------------------------------------
/// any     | none, or not locked with the code          | as before
/// asks    | who is invited                             | requests, if the folder is that node's; else the error
/// asks    | with it, an earlier try's refusal          | requests; those bytes are not heard again
/// requests| for no request yet, a refusal of another's | requests
/// requests| a refusal of this one                      | the error
/// requests| a certificate for another's request        | the error: the code is used
/// requests| the certificate                            | has it, once it is on disk; else the error
/// has it  | any, after it has written "done"           | over
class Joiner {
 public:
  /// This node's request, if the folder is the invited node's.
  using Ask = std::function<Result<SignedRecord>(const JoinOffer& invited)>;
  /// Checks the certificate and puts it on disk.
  using Take = std::function<Status(const JoinOffer& offer)>;

  Joiner(InvitationKeys keys, Ask ask, Take take)
      : keys_(std::move(keys)), ask_(std::move(ask)), take_(std::move(take)) {}

  /// What the next call carries, locked; empty: it only asks. The same bytes until there is something new to say.
  [[nodiscard]] const Bytes& message() const { return message_; }
  /// The answer to a call that carried message(). Errors end the joining.
  Status receive(BytesView offer);

  /// Does it know by an answer that its code is good?
  [[nodiscard]] bool is_invited() const { return state_ != State::asks; }
  /// The certificate is on disk.
  [[nodiscard]] bool has_joined() const { return state_ == State::has_it || state_ == State::over; }
  /// And the inviter's cloud node knows.
  [[nodiscard]] bool is_over() const { return state_ == State::over; }
  /// As it was signed, once has_joined().
  [[nodiscard]] const JoinOffer& offer() const { return offer_; }

 private:
  enum class State : unsigned char { asks, requests, has_it, over };
  void write(bool done);
  Status on_invited(const JoinOffer& offer);
  Status on_answer(JoinOffer offer);
  [[nodiscard]] bool is_refused(const JoinOffer& offer) const;

  InvitationKeys keys_;
  Ask ask_;
  Take take_;
  State state_ = State::asks;
  SignedRecord request_;
  JoinOffer offer_;
  Bytes message_;
  Bytes old_refusal_;  ///< the cloud node answers it until the inviter has read a word of this joiner
};

}  // namespace trb::op
