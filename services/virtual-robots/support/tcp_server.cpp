#include "services/virtual-robots/support/tcp_server.hpp"

namespace trb::virtual_robots {

TcpServer::TcpServer(const Endpoint& where, std::size_t most_clients, Extra extra)
    : TcpServer(listen_on(where), most_clients, extra) {}

TcpServer::TcpServer(Fd listener, std::size_t most_clients, Extra extra)
    : listener_(std::move(listener)), most_clients_(most_clients), extra_(extra) {}

void TcpServer::add_to_poll(std::vector<pollfd>& polled) {
  poll_begin_ = polled.size();
  const bool full = extra_ == Extra::waits && clients_.size() >= most_clients_;
  polled.push_back({full ? -1 : listener_.get(), POLLIN, 0});
  for (const Client& client : clients_) polled.push_back(client.polled());
}

void TcpServer::serve(const std::vector<pollfd>& polled, const std::function<void(Client&)>& taken) {
  std::size_t at = poll_begin_ + 1;
  for (Client& client : clients_) {
    const short found = polled[at++].revents;
    if (found & POLLOUT) client.flush();
    if (client.gone || !(found & (POLLIN | POLLHUP | POLLERR))) continue;
    read_from(client);
    if (!client.input.empty()) taken(client);
  }
  clients_.remove_if([](const Client& client) { return client.gone; });
  if (polled[poll_begin_].revents & POLLIN) accept_all();
}

void TcpServer::accept_all() {
  while (extra_ == Extra::dropped || clients_.size() < most_clients_) {
    Fd socket = accept_client(listener_);
    if (!socket) return;
    Client client;
    client.socket = std::move(socket);
    client.id = ++last_id_;
    if (clients_.size() == most_clients_) {
      client.drop("too_many_clients");
    } else {
      clients_.push_back(std::move(client));
    }
  }
}

void TcpServer::read_from(Client& client) {
  if (read_some(client.socket, client.input, 16384).kind == Transfer::Kind::closed) client.gone = true;
}

void TcpServer::send(Client& client, std::string_view bytes) {
  if (client.gone) return;
  client.output += bytes;
  client.flush();
  if (client.output.size() > kLargestOutput) client.drop("does_not_read");
}

TcpServer::Client* TcpServer::find(std::uint64_t id) {
  for (Client& client : clients_) {
    if (client.id == id && !client.gone) return &client;
  }
  return nullptr;
}

}  // namespace trb::virtual_robots
