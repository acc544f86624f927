// Replies in gzip (RFC 1952), for clients that take it.
#pragma once

#include "services/cloud-gateway/core/access/rights.hpp"
#include "services/cloud-gateway/io/http/exchange.hpp"

namespace trb::gateway {

/// Smaller ones fit a packet anyway.
constexpr std::size_t kLeastZipped = 1024;
/// A larger one would hold up the loop.
constexpr std::size_t kMostZipped = 2U << 20U;

/// Empty: zlib has no memory.
Bytes gzipped(BytesView bytes);

/// Whether a route's replies may be compressed: those to reads without a secret. A reply that has a secret beside text
/// of somebody else tells the secret by its length (BREACH): the session's CSRF value and new tokens go as they are.
bool may_zip(const Route& route);

/// Compresses a reply of JSON or text, if it is worth it. A reply with an ETag stays as it is: the tag names its bytes.
void zip(const Route& route, bool accepts_gzip, HttpReply& reply);

}  // namespace trb::gateway
