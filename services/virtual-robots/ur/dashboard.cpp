#include "services/virtual-robots/ur/dashboard.hpp"

#include <utility>

#include "services/virtual-robots/support/text.hpp"

namespace trb::virtual_robots::ur {
void Dashboard::add_to_poll(std::vector<pollfd>& polled) {
  poll_begin_ = polled.size();
  polled.push_back({listener_.get(), POLLIN, 0});
  for (const Client& client : clients_) {
    const int events = client.output.empty() ? POLLIN : POLLIN | POLLOUT;
    polled.push_back({client.socket.get(), static_cast<short>(events), 0});
  }
}

void Dashboard::serve(const std::vector<pollfd>& polled, Controller& controller, double now) {
  std::size_t at = poll_begin_;
  const bool knock = (polled[at++].revents & POLLIN) != 0;
  for (Client& client : clients_) {
    const short found = polled[at++].revents;
    if (found & (POLLIN | POLLHUP | POLLERR)) read_from(client, controller, now);
    flush(client);
  }
  std::erase_if(clients_, [](const Client& client) { return client.gone; });
  if (!knock) return;
  Fd socket = accept_client(listener_);
  if (!socket || clients_.size() == kMostClients) return;
  Client client;
  client.socket = std::move(socket);
  client.output = std::string(kDashboardGreeting) + "\n";
  flush(client);
  clients_.push_back(std::move(client));
}

void Dashboard::read_from(Client& client, Controller& controller, double now) {
  if (read_some(client.socket, client.input, 4096).kind == Transfer::Kind::closed) client.gone = true;
  for (std::size_t end; !client.leaves && (end = client.input.find('\n')) != std::string::npos;) {
    const std::string line(trim(std::string_view(client.input).substr(0, end)));
    client.input.erase(0, end + 1);
    client.output += words_.answer(line, controller, now) + "\n";
    client.leaves = line == "quit";
  }
  if (client.input.size() > kLongestLine || client.output.size() > kLargestOutput) client.gone = true;
}

void Dashboard::flush(Client& client) {
  const Transfer transfer = write_some(client.socket, client.output);
  client.output.erase(0, transfer.bytes);
  const bool said_all = client.leaves && client.output.empty();
  if (transfer.kind == Transfer::Kind::closed || said_all) client.gone = true;
}

}  // namespace trb::virtual_robots::ur
