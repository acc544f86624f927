#pragma once

#include <poll.h>

#include <string>
#include <string_view>
#include <vector>

#include "services/virtual-robots/support/socket.hpp"
#include "services/virtual-robots/ur/dashboard_answers.hpp"

namespace trb::virtual_robots::ur {

/** The dashboard's port: a greeting, then one answer per line. It never waits: the loop around it polls. */
class Dashboard {
 public:
  static constexpr std::size_t kMostClients = 8;
  static constexpr std::size_t kLongestLine = 1024;
  static constexpr std::size_t kLargestOutput = 64 * 1024;

  Dashboard(Fd listener, DashboardAnswers words) : listener_(std::move(listener)), words_(std::move(words)) {}

  std::uint16_t port() const { return port_of(listener_); }
  void add_to_poll(std::vector<pollfd>& polled);

  /** Serves what poll found, from the place where add_to_poll began. */
  void serve(const std::vector<pollfd>& polled, Controller& controller, double now);

 private:
  struct Client {
    Fd socket;
    std::string input;
    std::string output;
    bool leaves = false;  ///< once its output is sent
    bool gone = false;
  };

  void read_from(Client& client, Controller& controller, double now);
  void flush(Client& client);

  Fd listener_;
  DashboardAnswers words_;
  std::vector<Client> clients_;
  std::size_t poll_begin_ = 0;
};

}  // namespace trb::virtual_robots::ur
