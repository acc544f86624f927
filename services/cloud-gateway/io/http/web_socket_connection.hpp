#pragma once
#include <memory>

#include "services/cloud-gateway/io/http/connection.hpp"
#include "services/cloud-gateway/io/http/request_headers.hpp"
#include "services/cloud-gateway/io/http/stream.hpp"

namespace trb::gateway {

/// What an HTTP connection becomes once its upgrade is taken (RFC 6455): it reads one message after the other for `in`,
/// and sends one at a time. Ended by either side's close, by a message that is not text, or by a client that takes
/// nothing in time. All of the templates of Boost.Beast's WebSocket are compiled in its file alone.
std::shared_ptr<Connection> start_web_socket(Tls stream, ConnectionOwner& owner, ConnectionId id,
                                             std::shared_ptr<WebSocketIn> in, const ReadHead& head);

}  // namespace trb::gateway
