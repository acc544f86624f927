#pragma once

#include <poll.h>

#include <string>
#include <string_view>
#include <vector>

#include "services/virtual-robots/plc/modbus.hpp"
#include "services/virtual-robots/support/tcp_client.hpp"

namespace trb::virtual_robots::plc {

/** The Modbus TCP port and the clients on it. It never waits: the loop around it polls. */
class Server {
 public:
  static constexpr std::size_t kMostClients = 16;
  static constexpr std::size_t kLargestOutput = std::size_t{64} * 1024;

  explicit Server(const Endpoint& where);

  std::uint16_t port() const { return port_of(listener_); }
  void add_to_poll(std::vector<pollfd>& polled);
  /** Serves what poll found, from the place where add_to_poll began. */
  void serve(const std::vector<pollfd>& polled, Memory& memory);

 private:
  struct Client : TcpClient {
    Intake intake;
  };

  void accept_one();
  void read_from(Client& client, Memory& memory);

  Fd listener_;
  std::vector<Client> clients_;
  std::size_t poll_begin_ = 0;
};

}  // namespace trb::virtual_robots::plc
