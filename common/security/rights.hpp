// Who may what, by role, subtype (Travel, beside it) and signature. What is not named is denied. proto/README.md prints
// it, `trb help rights` too.
#pragma once

#include <string>
#include <string_view>

#include "proto/bodies/signed.hpp"
#include "proto/message.hpp"
#include "proto/travel.hpp"

namespace trb {

/// May what comes over a link, from a node of that role, bear this subtype? A user's own words may, from both roles.
bool may_cross(Role role, std::string_view subtype);

/// May a service send it to another node? No service sends what routers send to each other.
bool may_send_out(Role role, std::string_view subtype);

/// May this service (or a probe) of a node's own bus send it to another one there, or to the router?
bool may_send_on_bus(std::string_view service, bool probe, std::string_view subtype);

/// May this service take what bears the subtype? One of an operator's takes users' own words; the middleware's words it
/// may only listen to, so that it never stands in the way of who takes them.
bool may_take(std::string_view service, std::string_view subtype);

/// May this role sign records of that purpose (a kSigned… word)?
bool may_sign(Role role, std::string_view purpose);

/// May this service (or a probe) have its router sign records of that purpose?
bool may_have_signed(std::string_view service, bool probe, std::string_view purpose);

/// The tables as Markdown.
std::string rights_text();

}  // namespace trb
