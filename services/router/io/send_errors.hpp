// Why a frame was not sent, as its sender reads it in a Nack.
#pragma once

#include "common/base/errc.hpp"
#include "common/transport/socket.hpp"

namespace trb::router {

/// Why a service of this node did not get a message.
constexpr Errc why_undelivered(SendResult result) {
  return result == SendResult::full ? Errc::queue_full : Errc::no_service;
}

/// Why a link did not take a message.
constexpr Errc why_unsent(SendResult result) {
  return result == SendResult::full ? Errc::queue_full : Errc::peer_unreachable;
}

}  // namespace trb::router
