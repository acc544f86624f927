// What other gateways have written into a shared database, before something is decided.
#pragma once

#include "services/cloud-gateway/io/gateway.hpp"

namespace trb::gateway {

/// Access::refresh(), and what follows: live streams of who may not see the fleet any more end; if the database has not
/// answered for a second, all of them. Errors: why it does not answer.
Status refresh(Gateway& gateway);

/// The record of what was done, though the database does not answer: it is written as soon as it does. False: it is
/// lost, but for a line in the log.
bool put_off(Gateway& gateway, AuditRecord record);

/// Ends the live streams of who may not see the fleet any more.
void check_rights(const Gateway& gateway);

}  // namespace trb::gateway
