// The tables of the gateway's database and their versions: step n brings them from version n to n+1.
#pragma once

#include <span>

namespace trb::gateway {

std::span<const char* const> gateway_steps();           ///< of gateway.db, SQLite
std::span<const char* const> postgres_gateway_steps();  ///< as many; tables alike, in PostgreSQL's words

}  // namespace trb::gateway
