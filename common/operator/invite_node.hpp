#pragma once

#include <functional>
#include <memory>
#include <string>

#include "common/operator/inviter.hpp"
#include "common/operator/session.hpp"

namespace trb::op {

constexpr Duration kInviterPause = std::chrono::milliseconds(400);  ///< between two looks for words

struct InviteNode {
  std::string door;         ///< the cloud node that keeps the invitation
  SignedRecord invitation;  ///< by the authority
  Inviter inviter;
  Duration time = kInvitationTime;
  /// The cloud node keeps it, so the code can be given away.
  std::function<void()> on_held;
  /// What a message has brought; not called for Received::nothing.
  std::function<void(Inviter::Received received, const Inviter& inviter)> on_received;
  /// The cloud node does not answer; it is asked again until the time is over. Called once each time.
  std::function<void(const Error& why)> on_silent;
};

/// How an invitation has ended.
enum class InviteEnd : unsigned char {
  joined,       ///< the node has its certificate
  unconfirmed,  ///< a request was signed, and the node has not said that it has the answer
  unused,       ///< nobody has come
};

class Inviting;
using InvitingPtr = std::shared_ptr<Inviting>;

/// Deposits the invitation with the cloud node, and again if that one has forgotten it; takes words until the node has
/// joined or the time is over. Errors: what the cloud node answers to the first deposit.
InvitingPtr invite_node(Session& session, InviteNode order, Callback<InviteEnd> done);

/// Ends it now: nothing more is signed, the cloud node forgets the code, then `done` is called.
void end_inviting(const InvitingPtr& inviting);

}  // namespace trb::op
