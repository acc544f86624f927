// This node's lossy lane: who may listen, and what they receive. Its connections are pending until they subscribe.
#pragma once

#include <functional>
#include <map>
#include <memory>
#include <string>

#include "common/actor/counter_table.hpp"
#include "common/transport/byte_budget.hpp"
#include "common/transport/loop.hpp"
#include "common/transport/monitor.hpp"
#include "common/transport/socket.hpp"
#include "services/router/core/lane_table.hpp"
#include "services/router/io/inbox_guard.hpp"

namespace trb::router {

class LaneServer {
 public:
  struct Owner {
    std::function<void(Effects&)> carry_out;
    std::function<void(const char* event, const std::string& text)> warn;
    std::function<std::vector<std::string>()> friends;  ///< see InboxGuard::set_friends
  };
  /// ZAP must be bound before, and the context must have two I/O threads. `whole` bounds what waits in all queues of
  /// the node.
  LaneServer(Context& context, Loop& loop, LaneTable& lanes, CounterTable& counters, CurveKeys keys,
             const PendingConnectionLimits& inbox, std::shared_ptr<ByteBudget> whole, Owner owner);

  /// Binds this address; every other connection ends. Port 0: any. Errors: io_error (naming the address; no descriptor
  /// is left); then it is closed.
  Status open(const std::string& host, std::uint16_t port);
  void close();
  /// Binds this address too; empty: unbinds it.
  void also_at(const std::string& host);
  /// The port where it is open; 0: nowhere.
  [[nodiscard]] std::uint16_t port() const { return port_; }

  /// Publishes to the peer of that link, who listens to `topic`.
  SendResult publish(LinkId link, BytesView topic, Frame&& frame);
  /// The link is closed: its peer's lane connection is cut.
  void link_closed(LinkId link);
  /// Now and then, at a part of the connections: cuts those that send much where only a subscription is expected.
  void look(const LookPart& part);
  [[nodiscard]] std::size_t connections() const { return inbox_guard_.connections(); }

 private:
  struct Listener {
    PendingConnectionId pending = 0;
    std::shared_ptr<ByteBudget> budget;
  };

  Status bind(const std::string& endpoint);
  void drain();
  void on_request(const Frame& frame);
  void listen(LinkId link, PendingConnectionId pending, BytesView topic);
  PendingConnectionId pending_on(int fd);
  void on_incomplete(PendingConnectionId pending, const std::string& address);
  void on_event(LinkEvent event, int fd);
  void count(const std::string& name, const char* event, const std::string& text);

  Context& context_;
  Loop& loop_;
  LaneTable& lanes_;
  CounterTable& counters_;
  CurveKeys keys_;
  std::shared_ptr<ByteBudget> whole_;
  Owner owner_;
  InboxGuard inbox_guard_;
  std::unique_ptr<Socket> socket_;
  std::unique_ptr<SocketMonitor> monitor_;
  std::map<LinkId, Listener> listeners_;
  std::uint16_t port_ = 0;
  std::string also_;       ///< the second endpoint
  bool mixed_up_ = false;  ///< see on_request()
};

}  // namespace trb::router
