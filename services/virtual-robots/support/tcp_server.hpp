#pragma once

#include <poll.h>

#include <cstdint>
#include <functional>
#include <list>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "services/virtual-robots/support/tcp_client.hpp"

namespace trb::virtual_robots {

/** One listening port and its clients. It never waits: the loop around it polls. */
class TcpServer {
 public:
  static constexpr std::size_t kLargestOutput = std::size_t{1024} * 1024;

  struct Client : TcpClient {
    std::uint64_t id = 0;  ///< never reused
    std::string input;     ///< received bytes; the owner removes them from its front
  };

  /** What happens to a client too many: it is dropped at once, or is not accepted until another one leaves. */
  enum class Extra { dropped, waits };

  /** Port 0: a free one. Throws std::system_error. */
  TcpServer(const Endpoint& where, std::size_t most_clients, Extra extra = Extra::dropped);
  TcpServer(Fd listener, std::size_t most_clients, Extra extra = Extra::dropped);

  std::uint16_t port() const { return port_of(listener_); }
  std::size_t size() const { return clients_.size(); }

  void add_to_poll(std::vector<pollfd>& polled);

  /** Reads what poll found; `taken` is called with each client that has sent something. */
  void serve(const std::vector<pollfd>& polled, const std::function<void(Client&)>& taken);

  /** Queues bytes; a client with a megabyte of unread output is dropped. */
  void send(Client& client, std::string_view bytes);
  /** The client of that id, if it is still there. */
  Client* find(std::uint64_t id);

 private:
  void accept_all();
  void read_from(Client& client);

  Fd listener_;
  std::size_t most_clients_;
  Extra extra_;
  std::list<Client> clients_;  ///< a list, so that a client keeps its address
  std::uint64_t last_id_ = 0;
  std::size_t poll_begin_ = 0;
};

}  // namespace trb::virtual_robots
