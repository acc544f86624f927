#include "common/operator/inviter.hpp"

#include "proto/body.hpp"

namespace trb::op {
namespace {

constexpr std::size_t kMostSeen = 256;  ///< whoever has the code and sends more is not listened to

}  // namespace

Inviter::Inviter(InvitationKeys keys, JoinOffer open, Sign sign)
    : keys_(std::move(keys)), open_(std::move(open)), sign_(std::move(sign)) {
  answer(open_);
}

void Inviter::answer(JoinOffer offer) {
  ++number_;
  offer_ = lock_join(keys_.to_node, encode(offer));
}

Inviter::Received Inviter::receive(BytesView message) {
  if (seen_.size() >= kMostSeen || !seen_.insert(digest(message)).second) return Received::nothing;
  const auto plain = unlock_join(keys_.to_inviter, message);
  const auto read = plain ? decode<JoinWord>(*plain) : Result<JoinWord>(plain.error());
  if (!read) return Received::nothing;
  const Bytes request = digest_of_request(read->request);
  if (chosen_.empty()) return read->done ? Received::nothing : on_request(read->request, request);
  if (!same_bytes(request, chosen_)) return Received::second;
  return read->done ? Received::done : Received::nothing;
}

Inviter::Received Inviter::on_request(const SignedRecord& request, const Bytes& digest) {
  const auto wanted = decode<CertificateRequest>(request.payload.bytes);
  if (!wanted) return refuse(digest, wanted.error().text());
  if (wanted->id != open_.name || wanted->role != open_.role) {
    return refuse(digest, "the code is for '" + open_.name + "' (" + std::string(name_of(open_.role)) +
                              "), the request of '" + wanted->id + "' (" + std::string(name_of(wanted->role)) + ")");
  }
  auto offer = sign_(request);
  if (!offer) return refuse(digest, offer.error().text());
  chosen_ = digest;
  identity_ = wanted->identity_key.bytes;
  offer->request = {digest};
  answer(std::move(*offer));
  return Received::signed_one;
}

Inviter::Received Inviter::refuse(const Bytes& digest, const std::string& why) {
  refusal_ = why;
  JoinOffer offer = open_;
  offer.request = {digest};
  offer.refused = why.substr(0, kDefaultMaxSize);
  answer(std::move(offer));
  return Received::refused;
}

}  // namespace trb::op
