// Who may do what, by role, subtype (Travel, beside it) and signature. What is not named is denied. proto/README.md and
// `trb help rights` print it.
#pragma once

#include <string>
#include <string_view>

#include "proto/bodies/signed.hpp"
#include "proto/message.hpp"
#include "proto/travel.hpp"

namespace trb {

/// May a message that comes over a link, from a node of that role, have this subtype? A user's own subtypes may, from
/// both roles.
bool may_cross(Role role, std::string_view subtype);

/// May a service send it to another node? No service may send what belongs to routers.
bool may_send_out(Role role, std::string_view subtype);

/// May this service (or a probe) of a node's own bus send it to another service there, or to the router?
bool may_send_on_bus(std::string_view service, bool probe, std::string_view subtype);

/// The name by which the doctor comes to the bus with a service's own key: a visitor, beside the service itself.
std::string visitor_of(std::string_view service);

/// May a visitor send it? It asks its own node how the services are.
bool may_visitor_send(std::string_view subtype);

/// May this service take messages of the subtype? An operator's service takes users' own subtypes; of the middleware's
/// it may only receive copies, so that it never displaces the service that takes them.
bool may_take(std::string_view service, std::string_view subtype);

/// May this role sign records of that purpose (one of kSigned…)?
bool may_sign(Role role, std::string_view purpose);

/// May this service (or a probe) have its router sign records of that purpose?
bool may_have_signed(std::string_view service, bool probe, std::string_view purpose);

/// The tables as Markdown.
std::string rights_text();

}  // namespace trb
