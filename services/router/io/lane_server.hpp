// This node's lossy lane: who may listen to it, and what they are told. Its connections are visitors until they listen.
#pragma once

#include <functional>
#include <map>
#include <memory>
#include <string>

#include "common/transport/loop.hpp"
#include "common/transport/monitor.hpp"
#include "common/transport/socket.hpp"
#include "services/router/core/router_core.hpp"
#include "services/router/io/door.hpp"

namespace trb::router {

/// How much of what is large may wait for one who listens; of the rest the number is bounded (kLaneHighWaterMark).
class Backlog {
 public:
  static constexpr std::size_t kLarge = 64U << 10U;
  static constexpr std::size_t kMost = 4U << 20U;

  /// False if there is no room. `unsent` is what the kernel has of the connection: if that is little, nothing waits
  /// before it, once the I/O thread has had time to hand over what was sent last.
  bool take(std::size_t size, std::size_t unsent, MonotonicTime now);

 private:
  std::size_t waiting_ = 0;
  MonotonicTime last_;
};

class LaneServer {
 public:
  struct Owner {
    std::function<void(Effects&)> carry_out;
    std::function<void(const char* event, const std::string& text)> warn;
    std::function<std::vector<std::string>()> friends;  ///< see Door::set_friends
  };
  /// ZAP must be bound before, and the context have two I/O threads.
  LaneServer(Context& context, Loop& loop, RouterCore& core, CurveKeys keys, const VisitorLimits& inbox, Owner owner);

  /// At this address; every connection to another is gone. Port 0: any. Errors: io_error naming the address.
  Status open(const std::string& host, std::uint16_t port);
  void close();
  /// Also there; empty: there no more.
  void also_at(const std::string& host);
  /// Where it is open; 0: nowhere.
  [[nodiscard]] std::uint16_t port() const { return port_; }

  /// To the peer of that link, who listens to `topic`.
  SendResult publish(LinkId link, BytesView topic, Frame&& frame, MonotonicTime now);
  /// The link is closed: what listens because of it is cut.
  void link_closed(LinkId link);

 private:
  struct Listener {
    VisitorId visitor = 0;
    int fd = -1;
    Backlog backlog;
  };

  void drain();
  void on_word(const Frame& frame);
  void listen(LinkId link, VisitorId visitor, int fd, BytesView topic);
  VisitorId visitor_on(int fd);
  void on_event(LinkEvent event, int fd);
  void count(const std::string& name, const char* event, const std::string& text);

  Context& context_;
  Loop& loop_;
  RouterCore& core_;
  CurveKeys keys_;
  Owner owner_;
  Door door_;
  std::unique_ptr<Socket> socket_;
  std::unique_ptr<SocketMonitor> monitor_;
  std::map<LinkId, Listener> listeners_;
  std::uint16_t port_ = 0;
  std::string also_;       ///< the second endpoint
  bool mixed_up_ = false;  ///< see on_word()
};

}  // namespace trb::router
