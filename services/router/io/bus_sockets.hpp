// The node's own bus: one ROUTER socket for each service of node.json and one for probes, or one over TCP for all.
#pragma once

#include <map>
#include <memory>
#include <string>

#include "services/router/io/sent_counter.hpp"
#include "services/router/io/shared_queue.hpp"
#include "services/router/io/shell_context.hpp"
#include "services/router/io/shell_options.hpp"
#include "services/router/io/tap.hpp"
#include "services/router/io/tcp_bus_guard.hpp"

namespace trb::router {

class FrameForwarder;

/// The connections of services and probes: which service each proves to be, and how much may wait for it. The core
/// knows a connection once its Hello was accepted; what it sends from then on goes to the forwarder.
class BusSockets {
 public:
  BusSockets(ShellContext& shell, Tap& tap, FrameForwarder& forwarder, SentCounter& sent, TcpBus tcp);

  /// Binds the bus and the tap. Errors: io_error naming the address.
  Status open();
  /// ZAP's question, for a bus over TCP.
  bool admit(BytesView key) { return guard_ != nullptr && guard_->admit(key); }
  /// `unroutable`: that connection is gone, and the core was notified.
  SendResult send(ConnectionId to, Frame&& frame) { return send_of({}, to, std::move(frame)); }
  /// The same for a peer's frame: `full` also if that peer has its share of what waits for this connection.
  SendResult send_of(std::string_view peer, ConnectionId to, Frame&& frame);
  /// Now and then, of a bus over TCP: ends connections on which messages without a last part pile up.
  void look(const LookPart& part);
  /// Over TCP.
  [[nodiscard]] std::size_t connections() const { return guard_ == nullptr ? 0 : guard_->connections(); }

 private:
  struct Server {
    Socket socket;
    std::string name;  ///< the service it proves; empty: the key does
    std::map<Bytes, ConnectionId, std::less<>> connections;
    std::map<Bytes, MonotonicTime, std::less<>> asked;  ///< for their hello, not long ago
  };
  struct Connection {
    Server* server = nullptr;
    Bytes routing_id;
    std::string name;  ///< the service it proves
    std::unique_ptr<SharedQueue> queue;
    std::shared_ptr<IncompleteBytes> incomplete;  ///< on a bus over TCP
  };

  Status open_folder();
  Status open_tcp();
  void add_server(const std::string& key, Socket socket, const std::string& name);
  void drain(Server& server);
  void on_frame(Server& server, BytesView routing_id, Frame& frame);
  void add_bytes(ConnectionId from, const Frame& frame, std::uint64_t more = 0);
  [[nodiscard]] std::string whom_it_proves(const Server& server, const Frame& frame) const;         ///< empty: nobody
  ConnectionId connection_of(const Server& server, BytesView routing_id, const std::string& name);  ///< 0: none
  ConnectionId add_connection(Server& server, BytesView routing_id, const std::string& name);
  void on_hello_frame(Server& server, ConnectionId from, const std::string& name, const HeaderView& header,
                      const Frame& frame);
  void on_hello(Server& server, ConnectionId from, const std::string& name, const HeaderView& header);
  void free_dead_holder(const ServiceHello& hello, Effects& effects);
  void free_dead_probes(Server& server, ConnectionId requester, Effects& effects);
  bool is_gone(ConnectionId connection);
  void request_hello(Server& server, BytesView routing_id);
  void forget_unknown();
  void forget_connection(ConnectionId connection, Effects& effects);
  void forget_unroutable(ConnectionId connection);

  ShellContext& shell_;
  Tap& tap_;
  FrameForwarder& forwarder_;
  SentCounter& sent_;
  TcpBus tcp_;
  std::map<std::string, std::unique_ptr<Server>> servers_;
  std::map<ConnectionId, Connection> connections_;
  ConnectionId next_connection_ = 0;
  std::unique_ptr<TcpBusGuard> guard_;  ///< of a bus over TCP; destroyed before the sockets that it watches
};

}  // namespace trb::router
