// What libzmq tells of a socket's connections.
#pragma once

#include <functional>
#include <string>

#include "common/transport/loop.hpp"
#include "common/transport/socket.hpp"

namespace trb {

enum class LinkEvent {
  connected,  ///< the handshake is done: both sides hold their keys
  failed,     ///< no TCP connection, or it broke before the handshake
  disconnected,
  refused_key,       ///< the other side's ZAP said no
  no_curve,          ///< the other side does not speak CURVE
  wrong_server_key,  ///< the handshake's cryptography failed
  protocol_error,    ///< anything else that is no ZMTP
};

/// Watches one socket; the events come on the loop's thread.
class SocketMonitor {
 public:
  SocketMonitor(Context& context, Loop& loop, Socket& socket, std::function<void(LinkEvent)> on_event);
  ~SocketMonitor();
  SocketMonitor(const SocketMonitor&) = delete;
  SocketMonitor& operator=(const SocketMonitor&) = delete;

 private:
  void serve();
  Loop& loop_;
  Socket& socket_;
  Socket pair_;
  std::function<void(LinkEvent)> on_event_;
};

}  // namespace trb
