#include "services/router/core/peers.hpp"

#include "common/base/address.hpp"
#include "proto/body.hpp"

namespace trb::router {

bool fits(const NodeProfile& profile) {
  const auto packed = pack(profile);
  return packed && packed->size() <= kMaxProfileSize;
}

Status check_address(std::string_view field, std::string_view address, std::string_view whose) {
  if (address.empty() || is_numeric_endpoint(address)) return Done{};
  return fail(Errc::bad_value,
              std::string(field) + " of '" + std::string(whose) + "' is no IPv4 or IPv6 address with a port: '" +
                  std::string(address) + "'",
              "a node tells where it is in numbers: install this release there; a name may stand in \"seeds\" alone");
}

bool new_link_wins(const Link& old_link, const Link& new_link, bool own_id_is_smaller) {
  if (new_link.boot != old_link.boot) return new_link.boot > old_link.boot;
  if (new_link.own_address != old_link.own_address || new_link.peer_address != old_link.peer_address) return true;
  if (new_link.dialled == old_link.dialled) return true;
  return new_link.dialled == own_id_is_smaller;
}

}  // namespace trb::router
