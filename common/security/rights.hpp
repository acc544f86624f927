// Who may what: the one table of roles, subtypes and signatures. What it does not name is denied. proto/README.md
// prints it, `trb help rights` too.
#pragma once

#include <span>
#include <string>
#include <string_view>

#include "proto/bodies/signed.hpp"
#include "proto/message.hpp"

namespace trb {

/// Between whom a subtype goes.
enum class Road : unsigned char {
  fleet,   ///< from a service of one node to a service or the router of another, or on one node
  link,    ///< between the two routers of a link
  bus,     ///< between the services of one node and its router
  record,  ///< never a message: inside a signed record, a file or a datagram
};

struct SubtypeRight {
  std::string_view subtype;
  Road road;
  bool robot;  ///< a node of this role may send it over a link
  bool cloud;
};

/// The right of a typed subtype, or nullptr: then nobody has it.
const SubtypeRight* find_right(std::string_view subtype);

/// May what comes over a link, from a node of that role, bear this subtype? A user's own words may, from both roles.
bool may_cross(Role role, std::string_view subtype);

/// May a service send it to another node? What routers say to each other, no service says.
bool may_send_out(Role role, std::string_view subtype);

/// May this service (or a probe) of a node's own bus say it to another one there, or to the router?
bool may_say(std::string_view service, bool probe, std::string_view subtype);

/// A name of the middleware's own services, or of what else stands on a bus ("probe", "tap"): no operator's service
/// bears it.
bool is_reserved_service(std::string_view name);

/// May this service take what bears the subtype? One of an operator's takes users' own words; the middleware's words it
/// may hear, so that it never stands in the way of who takes them.
bool may_take(std::string_view service, std::string_view subtype);

/// May this role sign records of that purpose (a kSigned… word)?
bool may_sign(Role role, std::string_view purpose);

/// May this service (or a probe) have its router sign records of that purpose?
bool may_have_signed(std::string_view service, bool probe, std::string_view purpose);

/// The tables as Markdown.
std::string rights_text();

}  // namespace trb
