#include "services/virtual-robots/plc/server.hpp"

#include "services/virtual-robots/support/process.hpp"

namespace trb::virtual_robots::plc {
namespace {

constexpr std::size_t kReadSize = 4096;

}  // namespace

Server::Server(const Endpoint& where) : listener_(listen_on(where)) {}

void Server::add_to_poll(std::vector<pollfd>& polled) {
  poll_begin_ = polled.size();
  polled.push_back({listener_.get(), POLLIN, 0});
  for (const Client& client : clients_) polled.push_back(client.polled());
}

void Server::serve(const std::vector<pollfd>& polled, Memory& memory) {
  std::size_t at = poll_begin_ + 1;
  for (Client& client : clients_) {
    const short found = polled[at++].revents;
    if (found & POLLOUT) client.flush();
    if (!client.gone && (found & (POLLIN | POLLHUP | POLLERR))) read_from(client, memory);
  }
  std::erase_if(clients_, [](const Client& client) { return client.gone; });
  if (polled[poll_begin_].revents & POLLIN) accept_one();
}

void Server::accept_one() {
  Fd socket = accept_client(listener_);
  if (!socket) return;
  if (clients_.size() == kMostClients) return print_line("client_dropped too_many_clients");
  Client client;
  client.socket = std::move(socket);
  clients_.push_back(std::move(client));
}

void Server::read_from(Client& client, Memory& memory) {
  std::string bytes;
  const Transfer transfer = read_some(client.socket, bytes, kReadSize);
  client.gone = transfer.kind == Transfer::Kind::Closed;
  if (client.gone) return;
  client.output += client.intake.take(bytes, memory);
  client.flush();
  if (client.gone) return;
  if (client.intake.broken()) client.drop("no_modbus");
  if (client.output.size() > kLargestOutput) client.drop("does_not_read");
}

}  // namespace trb::virtual_robots::plc
