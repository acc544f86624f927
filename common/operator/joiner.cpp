#include "common/operator/joiner.hpp"

#include "proto/body.hpp"

namespace trb::op {

void Joiner::write(bool done) {
  word_ = lock_join(keys_.to_inviter, encode(JoinWord{request_, done}));
}

Status Joiner::hear(BytesView box) {
  if (state_ == State::has_it) state_ = State::over;
  if (state_ == State::over) return Done{};
  // A cloud node that answers rubbish can only keep it waiting.
  const auto plain = unlock_join(keys_.to_node, box);
  auto offer = plain ? decode<JoinOffer>(*plain) : Result<JoinOffer>(plain.error());
  if (!offer) return Done{};
  return state_ == State::asks ? on_invited(std::move(*offer)) : on_answer(std::move(*offer));
}

Status Joiner::on_invited(JoinOffer offer) {
  auto request = ask_(offer);
  if (!request) return request.error();
  request_ = std::move(*request);
  state_ = State::requests;
  write(false);
  return on_answer(std::move(offer));
}

Status Joiner::on_answer(JoinOffer offer) {
  if (offer.request.bytes.empty()) return Done{};
  const bool own = same_bytes(offer.request.bytes, digest_of_request(request_));
  if (!own && !offer.refused.empty()) return Done{};
  if (!own) {
    return fail(
        Errc::already_claimed, "the code was used: another node has joined with it as '" + offer.name + "'",
        "if that was not you, whoever has the authority's key ends it: trb fleet revoke FLEET_DIR " + offer.name);
  }
  if (!offer.refused.empty()) return fail(Errc::not_permitted, "the inviter has not signed: " + offer.refused);
  if (Status taken = take_(offer); !taken) return taken;
  offer_ = std::move(offer);
  state_ = State::has_it;
  write(true);
  return Done{};
}

}  // namespace trb::op
