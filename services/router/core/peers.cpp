#include "services/router/core/peers.hpp"

namespace trb::router {

bool new_link_wins(const Link& old_link, const Link& new_link, bool own_id_is_smaller) {
  if (new_link.boot != old_link.boot) return new_link.boot > old_link.boot;
  if (new_link.own_address != old_link.own_address || new_link.peer_address != old_link.peer_address) return true;
  if (new_link.dialled == old_link.dialled) return true;
  return new_link.dialled == own_id_is_smaller;
}

}  // namespace trb::router
