// Who may use the node's bus over TCP.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "services/router/io/inbox_guard.hpp"
#include "services/router/io/shell_context.hpp"
#include "services/router/io/shell_options.hpp"

namespace trb::router {

/// A connection of the bus proves by its key which service it is; one that has shown no key of this node is pending, as
/// at the inbox. Refused connections are counted and logged.
class TcpBusGuard {
 public:
  TcpBusGuard(ShellContext& shell, std::map<Bytes, std::string, std::less<>> names);

  /// Call it before the sockets are bound: it must see each connection, and the listening sockets themselves. Errors:
  /// io_error (no descriptor is left).
  Status watch(Socket& bus, Socket& tap);
  /// ZAP's question: is this the key of a service of this node, or of trb?
  bool admit(BytesView key);
  /// The service that the frame's connection has proven to be, or "probe"; empty: none.
  [[nodiscard]] std::string name_of(const Frame& frame) const;
  /// A Hello came on the frame's connection, which was `accepted` or refused.
  void on_hello(const Frame& frame, bool accepted);
  /// The tap's connection with this descriptor listens: whoever has a key of this node may.
  void on_tap_listener(int fd);

  /// See InboxGuard: what was received of the frame's connection; messages without a last part.
  std::shared_ptr<IncompleteBytes> incomplete_of(const Frame& frame);
  bool look(const LookPart& part);
  [[nodiscard]] std::size_t connections() const { return guard_.connections(); }
  void on_empty() { guard_.on_empty(); }
  void on_turn(std::size_t messages) { guard_.on_turn(messages); }

 private:
  Status watch(Socket& socket);
  PendingConnectionId pending_of(const Frame& frame);
  void on_event(LinkEvent event, int fd);
  void refused(const char* name, const char* text);

  ShellContext& shell_;
  std::map<Bytes, std::string, std::less<>> names_;
  InboxGuard guard_;
  std::vector<std::unique_ptr<SocketMonitor>> monitors_;  ///< of the bus, and of the tap
};

}  // namespace trb::router
