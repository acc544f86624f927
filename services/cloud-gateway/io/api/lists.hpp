// Lists and single rows of the fleet as replies.
#pragma once

#include "services/cloud-gateway/io/api/call.hpp"
#include "services/cloud-gateway/io/gateway.hpp"

namespace trb::gateway {

/// A page of all rows of that kind: {"items": [ROW], "next": CURSOR or ""}; `?limit=` (100) and `?cursor=`. With
/// "silent": who tells this gateway nothing now (json_silent).
void reply_rows(const Gateway& gateway, const CallPtr& call, RowKind kind);
/// One row, with its ETag; 304 if the client has it, 404 if there is none.
void reply_row(const Gateway& gateway, const CallPtr& call, const RowKey& key);

}  // namespace trb::gateway
