#pragma once

#include "common/operator/session.hpp"
#include "proto/bodies/link.hpp"

namespace trb::op {

/// The node's whole routing table, page by page: robots, sensors, addresses, each node's profile. `wait` is for each
/// page. Errors: those of Session::request; conflict (not the requested page).
void request_routes(Session& session, Callback<RouteTable> done, Duration wait = kAnswerWait);

/// The ids of the fleet's robots.
std::vector<std::string> robots_of(const RouteTable& table);

/// Why a scenario may not be refused by this table: its router has just started, and may not have heard all
/// members again.
/// Errors: peer_unreachable.
Status check_whole(const RouteTable& table);

/// True if messages reach this node now.
bool is_reached(const Route& route);

}  // namespace trb::op
