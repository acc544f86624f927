#include "services/router/core/nack.hpp"

#include "proto/body.hpp"
#include "services/router/core/lane.hpp"

namespace trb::router {

bool deserves_nack(const HeaderView& header) {
  if (header.reply_to != 0 || header.id == 0 || is_lossy(header)) return false;
  return header.type != MessageType::information || !is_reserved(header.subtype);
}

bool deserves_nack_elsewhere(const HeaderView& header) {
  return header.target != kEveryNode && deserves_nack(header);
}

std::string undelivered_counter(Errc reason) {
  const bool refused = reason == Errc::source_mismatch || reason == Errc::not_permitted ||
                       reason == Errc::unknown_peer_key || reason == Errc::not_asked;
  return (refused ? "refused." : "dropped.") + std::string(errc_name(reason));
}

}  // namespace trb::router
