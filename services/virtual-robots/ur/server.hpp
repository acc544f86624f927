#pragma once

#include <poll.h>

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "services/virtual-robots/support/tcp_client.hpp"
#include "services/virtual-robots/ur/intake.hpp"

namespace trb::virtual_robots::ur {

/** The ports of a controller's interfaces and the clients on them. It never waits: the loop around it polls. */
class Server {
 public:
  static constexpr std::size_t kMostClients = 16;
  static constexpr std::size_t kLargestOutput = std::size_t{1024} * 1024;

  /** Listens on base+1, +2, +11 and +12, on base-1 for the dashboard and base+4 for RTDE; without a base, on free
   * ports.
   */
  Server(const std::string& address, std::optional<std::uint16_t> base);

  std::uint16_t primary_port() const { return port_of(ports_[0].listener); }
  std::uint16_t secondary_port() const { return port_of(ports_[1].listener); }

  /** The dashboard's listening socket. */
  Fd take_dashboard() { return std::move(dashboard_); }
  Fd take_rtde() { return std::move(rtde_); }

  void add_to_poll(std::vector<pollfd>& polled);

  /** Serves what poll found, from the place where add_to_poll began; returns the received scripts, in order. */
  std::vector<std::string> serve(const std::vector<pollfd>& polled);

  void send_to_primary(std::string_view packet) { send(packet, true); }
  void send_to_all(std::string_view packet) { send(packet, false); }

  /** Sends packets to the clients that are new since the last call. */
  void greet(std::string_view packets);

 private:
  struct Port {
    Fd listener;
    bool primary = false;
    bool read_only = false;
  };

  struct Client : TcpClient {
    bool primary = false;
    bool read_only = false;
    bool greeted = false;
    Intake intake;
  };

  bool listen_from(const std::string& address, std::uint16_t base);
  void accept_from(const Port& port);
  void read_from(Client& client, std::vector<std::string>& scripts);
  void queue(Client& client, std::string_view packet);
  void send(std::string_view packet, bool primary_only);
  void forget_gone();

  std::vector<Port> ports_;
  Fd dashboard_;
  Fd rtde_;
  std::vector<Client> clients_;
  std::size_t poll_begin_ = 0;
};

}  // namespace trb::virtual_robots::ur
