// The status line and headers of a reply, with those that every reply has. Pure.
#pragma once

#include <span>
#include <string>
#include <string_view>
#include <utility>

#include "common/base/result.hpp"
#include "common/base/time.hpp"
#include "services/cloud-gateway/io/http/exchange.hpp"

namespace trb::gateway {

/// What tells a browser to do less: encryption, no foreign scripts, frames or types.
std::span<const std::pair<std::string_view, std::string_view>> security_headers();

/// All up to the body, with the empty line. `now` is the Date. Errors: bad_value, for a header that the server writes
/// itself, or with bytes that no header may have (so CR and LF too, RFC 9110, 5.5); then nothing of it may be sent.
Result<std::string> reply_head(const HttpReply& reply, bool keep_alive, UtcTime now);

/// RFC 9110, 6.4.1: false for 1xx, 204 and 304.
bool may_have_body(int status);

}  // namespace trb::gateway
