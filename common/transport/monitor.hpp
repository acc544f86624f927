// What libzmq tells of a socket's connections.
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
  refused_key,       ///< the other side's ZAP said no
  no_curve,          ///< the other side does not speak CURVE
  wrong_server_key,  ///< the handshake's cryptography failed
  protocol_error,    ///< anything else that is no ZMTP
  listening,         ///< an endpoint is bound
  accepted,          ///< a TCP connection came; it has proven nothing
  accept_failed,     ///< one could not be taken: no descriptor was left
};

/// For a socket without a loop of its own: has the other side refused its key?
class RefusalWatch {
 public:
  RefusalWatch(Context& context, Socket& socket);
  ~RefusalWatch();
  RefusalWatch(const RefusalWatch&) = delete;
  RefusalWatch& operator=(const RefusalWatch&) = delete;
  /// True if it did since the last look.
  bool refused();

 private:
  Socket& socket_;
  Socket pair_;
};

/// Watches one socket; the events come on the loop's thread, later than what they tell of. `fd` is the descriptor of
/// listening, accepted, connected and disconnected, else -1; it may have been closed since.
class SocketMonitor {
 public:
  using OnEvent = std::function<void(LinkEvent event, int fd)>;
  /// Errors: io_error (no descriptor is left).
  static Result<std::unique_ptr<SocketMonitor>> watch(Context& context, Loop& loop, Socket& socket, OnEvent on_event);
  ~SocketMonitor();
  SocketMonitor(const SocketMonitor&) = delete;
  /// Tells at once what has happened up to now: a frame may be read before the loop comes to its connection's events.
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
  std::shared_ptr<int> here_ = std::make_shared<int>();  ///< gone with this object
};

}  // namespace trb
