#pragma once

#include <map>

#include "services/virtual-robots/plc/modbus.hpp"
#include "services/virtual-robots/support/tcp_server.hpp"

namespace trb::virtual_robots::plc {

/** The Modbus TCP port. It never waits: the loop around it polls. */
class Server {
 public:
  explicit Server(const Endpoint& where);

  std::uint16_t port() const { return server_.port(); }
  void add_to_poll(std::vector<pollfd>& polled) { server_.add_to_poll(polled); }
  /** Serves what poll found, from the place where add_to_poll began. */
  void serve(const std::vector<pollfd>& polled, Memory& memory);

 private:
  void take(TcpServer::Client& client, Memory& memory);

  TcpServer server_;
  std::map<std::uint64_t, Intake> intakes_;  ///< by client
};

}  // namespace trb::virtual_robots::plc
