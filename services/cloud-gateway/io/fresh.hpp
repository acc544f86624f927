// What other gateways have written into a shared database, before something is decided; and what a database that does
// not take anything now means for a request.
#pragma once

#include <string>

#include "services/cloud-gateway/io/api/call.hpp"
#include "services/cloud-gateway/io/gateway.hpp"

namespace trb::gateway {

/// Access::refresh(), and what follows: live streams of who may not see the fleet any more end; if the database has not
/// answered for a second, all of them. Errors: why it does not answer.
Status refresh(Gateway& gateway);

/// The record of what was done, though the database does not answer: it is written as soon as it does. False: it is
/// lost, but for a line in the log.
bool put_off(Gateway& gateway, AuditRecord record);

/// What a request is answered whose change could not be written, and so was not done. `has_begun`: the fleet was told
/// all the same.
HttpReply unwritten_reply(const Gateway& gateway, const Error& error, bool has_begun = false);

/// The same to a call that has done nothing yet.
void fail_unwritten(const Gateway& gateway, Call& call, const Error& error);

/// For people, while the disk is full; empty: it is not.
std::string full_note(const Gateway& gateway);

/// Ends the live streams of who may not see the fleet any more.
void check_rights(const Gateway& gateway);

}  // namespace trb::gateway
