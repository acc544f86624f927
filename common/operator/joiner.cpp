#include "common/operator/joiner.hpp"

#include "proto/body.hpp"

namespace trb::op {

void Joiner::write(bool done) {
  message_ = lock_join(keys_.to_inviter, encode(JoinWord{request_, done}));
}

Status Joiner::receive(BytesView box) {
  if (state_ == State::has_it) state_ = State::over;
  if (state_ == State::over || (!old_refusal_.empty() && box == old_refusal_)) return Done{};
  // A cloud node that answers rubbish can only keep it waiting.
  const auto plain = unlock_join(keys_.to_node, box);
  auto offer = plain ? decode<JoinOffer>(*plain) : Result<JoinOffer>(plain.error());
  if (!offer) return Done{};
  if (state_ != State::asks) return on_answer(std::move(*offer));
  Status invited = on_invited(*offer);
  if (!invited) return invited;
  if (!is_refused(*offer)) return on_answer(std::move(*offer));
  // It was meant for an earlier word than any of this joiner: what it names may have been put right since.
  old_refusal_ = Bytes(box);
  return Done{};
}

Status Joiner::on_invited(const JoinOffer& offer) {
  auto request = ask_(offer);
  if (!request) return request.error();
  request_ = std::move(*request);
  state_ = State::requests;
  write(false);
  return Done{};
}

bool Joiner::is_refused(const JoinOffer& offer) const {
  return !offer.refused.empty() && same_bytes(offer.request.bytes, digest_of_request(request_));
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
