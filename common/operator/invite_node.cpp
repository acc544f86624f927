#include "common/operator/invite_node.hpp"

#include <utility>

#include "proto/body.hpp"

namespace trb::op {

class Inviting {
 public:
  Inviting(Session& session, InviteNode order, Callback<InviteEnd> done)
      : session_(session), order_(std::move(order)), done_(std::move(done)), until_(session.now().mono + order_.time) {}

  void look(const InvitingPtr& self) {
    const bool last = is_over();
    HoldInvitation body{order_.invitation, order_.inviter.number(), {}, last};
    if (last && !order_.inviter.has_signed()) body.number = 0;
    if (known_ != order_.inviter.number() && body.number != 0) body.offer = {order_.inviter.offer()};
    session_.request(Send{.type = MessageType::request, .target = order_.door, .body = std::move(body)},
                     [self, last](Result<Message> answer) { self->on_answer(self, std::move(answer), last); });
  }

  void end(const InvitingPtr& self) {
    ended_ = true;
    if (!finished_ && !std::exchange(asking_, true)) look(self);
  }

  void begin(const InvitingPtr& self) {
    asking_ = true;
    look(self);
  }

 private:
  [[nodiscard]] bool is_over() const { return ended_ || confirmed_ || session_.now().mono >= until_; }

  void on_answer(const InvitingPtr& self, Result<Message> answer, bool last) {
    auto state = answer ? decode<InvitationState>(answer->data) : Result<InvitationState>(answer.error());
    if (state) on_state(*state);
    if (last) return finish();
    if (!state && !held_) {
      finished_ = true;
      return done_(state.error());
    }
    if (!state && !std::exchange(silent_, true) && order_.on_silent) order_.on_silent(state.error());
    if (is_over()) return look(self);
    asking_ = false;
    session_.after(kInviterPause, [self] {
      if (std::exchange(self->asking_, true)) return;
      self->look(self);
    });
  }

  void on_state(const InvitationState& state) {
    known_ = state.number;
    silent_ = false;
    if (!std::exchange(held_, true) && order_.on_held) order_.on_held();
    for (const JoinCall& call : state.words) {
      // Nobody looks after a code that is withdrawn: what waits is not signed any more.
      if (is_over() && !order_.inviter.has_signed()) return;
      const auto received = order_.inviter.receive(call.word.bytes);
      if (received == Inviter::Received::nothing) continue;
      confirmed_ = confirmed_ || received == Inviter::Received::done;
      if (order_.on_received) order_.on_received(received, order_.inviter);
    }
  }

  void finish() {
    if (std::exchange(finished_, true)) return;
    done_(confirmed_ ? InviteEnd::joined : order_.inviter.has_signed() ? InviteEnd::unconfirmed : InviteEnd::unused);
  }

  Session& session_;
  InviteNode order_;
  Callback<InviteEnd> done_;
  MonotonicTime until_;
  std::uint64_t known_ = 0;  ///< the offer that the cloud node has
  bool asking_ = false;
  bool held_ = false;
  bool silent_ = false;
  bool ended_ = false;
  bool confirmed_ = false;
  bool finished_ = false;
};

InvitingPtr invite_node(Session& session, InviteNode order, Callback<InviteEnd> done) {
  auto inviting = std::make_shared<Inviting>(session, std::move(order), std::move(done));
  inviting->begin(inviting);
  return inviting;
}

void end_inviting(const InvitingPtr& inviting) {
  inviting->end(inviting);
}

}  // namespace trb::op
