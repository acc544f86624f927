// What libzmq reports about a socket's connections.
#pragma once

#include <functional>
#include <memory>
#include <string>

#include "common/transport/loop.hpp"
#include "common/transport/socket.hpp"

namespace trb {

enum class LinkEvent {
  connected,  ///< the handshake is done: both sides hold their keys
  failed,     ///< no TCP connection, or it broke before the handshake
  disconnected,
  refused_key,       ///< the other side's ZAP refused it
  no_curve,          ///< the other side does not speak CURVE
  wrong_server_key,  ///< the handshake's cryptography failed
  protocol_error,    ///< anything else that is not ZMTP
  reached,           ///< this side's TCP connection is made; nothing is proven yet
  listening,         ///< an endpoint is bound
  accepted,          ///< a TCP connection was accepted; nothing is proven yet
  accept_failed,     ///< one could not be accepted: no descriptor was left
};

/// For a dialled socket without a loop of its own: what became of its connection. Create it before the socket is
/// dialled.
class ConnectionWatch {
 public:
  /// Throws std::runtime_error (no descriptor is left).
  ConnectionWatch(Context& context, Socket& socket);
  ~ConnectionWatch();
  ConnectionWatch(const ConnectionWatch&) = delete;
  ConnectionWatch& operator=(const ConnectionWatch&) = delete;
  /// True if the other side has refused the key since the last call.
  bool take_refused();
  /// True if a connection has ended since the last call; known before the socket can have the next connection.
  bool take_ended();
  /// True once a connection was made, whatever came of it: somebody listens there.
  bool was_reached();

 private:
  void look();

  Socket& socket_;
  Socket pair_;
  bool refused_ = false;
  bool ended_ = false;
  bool reached_ = false;
};

/// Watches one socket; the events arrive on the loop's thread, later than they happened. `fd` is the descriptor of
/// listening, accepted, reached and disconnected, else -1; it may have been closed since.
class SocketMonitor {
 public:
  using OnEvent = std::function<void(LinkEvent event, int fd)>;
  /// Errors: io_error (no descriptor is left).
  static Result<std::unique_ptr<SocketMonitor>> watch(Context& context, Loop& loop, Socket& socket, OnEvent on_event);
  ~SocketMonitor();
  SocketMonitor(const SocketMonitor&) = delete;
  /// Reports at once what has happened so far: a frame may be read before the loop reaches its connection's events.
  void catch_up();
  SocketMonitor& operator=(const SocketMonitor&) = delete;

 private:
  SocketMonitor(Loop& loop, Socket& socket, Socket pair, OnEvent on_event);
  void serve();
  bool serve_one();
  Loop& loop_;
  Socket& socket_;
  Socket pair_;
  OnEvent on_event_;
  std::shared_ptr<int> here_ = std::make_shared<int>();  ///< destroyed with this object: a weak pointer to it shows
                                                         ///< whether it still exists
};

}  // namespace trb
