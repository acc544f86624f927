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
  for (const Client& client : clients_) {
    const int events = client.output.empty() ? POLLIN : POLLIN | POLLOUT;
    polled.push_back({client.socket.get(), static_cast<short>(events), 0});
  }
}

void Server::serve(const std::vector<pollfd>& polled, Memory& memory) {
  std::size_t at = poll_begin_ + 1;
  for (Client& client : clients_) {
    const short found = polled[at++].revents;
    if (found & POLLOUT) flush(client);
    if (!client.gone && (found & (POLLIN | POLLHUP | POLLERR))) read_from(client, memory);
  }
  std::erase_if(clients_, [](const Client& client) { return client.gone; });
  if (polled[poll_begin_].revents & POLLIN) accept_one();
}

void Server::accept_one() {
  Fd socket = accept_client(listener_);
  if (!socket) return;
  if (clients_.size() == kMostClients) return print_line("client_dropped too_many_clients");
  clients_.push_back({std::move(socket), {}, {}, false});
}

void Server::read_from(Client& client, Memory& memory) {
  std::string bytes;
  const Transfer transfer = read_some(client.socket, bytes, kReadSize);
  client.gone = transfer.kind == Transfer::Kind::Closed;
  if (client.gone) return;
  client.output += client.intake.take(bytes, memory);
  flush(client);
  if (client.gone) return;
  if (client.intake.broken()) drop(client, "no_modbus");
  if (client.output.size() > kLargestOutput) drop(client, "does_not_read");
}

void Server::flush(Client& client) {
  if (client.output.empty()) return;
  const Transfer transfer = write_some(client.socket, client.output);
  if (transfer.kind == Transfer::Kind::Closed) client.gone = true;
  client.output.erase(0, transfer.bytes);
}

void Server::drop(Client& client, std::string_view reason) {
  client.gone = true;
  print_line("client_dropped " + std::string(reason));
}

}  // namespace trb::virtual_robots::plc
