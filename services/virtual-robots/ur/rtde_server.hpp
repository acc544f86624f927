#pragma once

#include <map>
#include <memory>

#include "services/virtual-robots/support/tcp_server.hpp"
#include "services/virtual-robots/ur/rtde_session.hpp"

namespace trb::virtual_robots::ur {

/** The port of the real-time data exchange. It never waits: the loop around it polls. */
class RtdeServer {
 public:
  static constexpr std::size_t kMostClients = 8;
  /** A client that reads slower than it asked for misses packages. */
  static constexpr std::size_t kMostUnread = std::size_t{64} * 1024;

  explicit RtdeServer(Fd listener) : server_(std::move(listener), kMostClients) {}

  std::uint16_t port() const { return server_.port(); }
  void add_to_poll(std::vector<pollfd>& polled) { server_.add_to_poll(polled); }

  /** Serves what poll found. `now`: the robot's time. */
  void serve(const std::vector<pollfd>& polled, Controller& controller, double now);
  /** Sends the data packages that are due. */
  void send_due(const Controller& controller, double now);
  /** In real time; infinite: nothing is due. */
  double next_due() const;

 private:
  void forget_gone();
  void take(TcpServer::Client& client, Controller& controller, double now);

  TcpServer server_;
  RtdeClaims claims_;
  RtdeWritten written_;
  std::map<std::uint64_t, std::unique_ptr<RtdeSession>> sessions_;
};

}  // namespace trb::virtual_robots::ur
