// Replies and changes that depend on the version that the client has (RFC 9110, section 13).
#pragma once

#include <optional>

#include "services/cloud-gateway/core/live/etag.hpp"
#include "services/cloud-gateway/io/api/call.hpp"

namespace trb::gateway {

/// Replies with a resource and its ETag: 304 if the client has this version, 412 if it wants another one.
void reply_tagged(const CallPtr& call, const ETag& tag, HttpReply resource);

/// Why the resource must not be changed: 428 without If-Match, 412 if the client has read another version. nullopt: go
/// on.
std::optional<HttpReply> refused_change(const Call& call, const ETag& tag);

}  // namespace trb::gateway
