#include "services/virtual-robots/ur/server.hpp"

#include <algorithm>
#include <cerrno>
#include <system_error>

#include "services/virtual-robots/support/process.hpp"

namespace trb::virtual_robots::ur {
namespace {

struct Offset {
  std::uint16_t port;
  bool primary;
  bool read_only;
};

constexpr Offset kOffsets[] = {{1, true, false}, {2, false, false}, {11, true, true}, {12, false, true}};

/** A port that is free at the moment, so that its neighbours probably are free as well. */
std::uint16_t probable_base(const std::string& address) {
  const std::uint16_t port = port_of(listen_on({address, 0}));
  return static_cast<std::uint16_t>(std::min<int>(port, 65500) - 1);
}

}  // namespace

Server::Server(const std::string& address, std::optional<std::uint16_t> base) {
  constexpr int kTries = 100;
  const int tries = base ? 1 : kTries;
  for (int i = 0; i < tries; ++i) {
    if (listen_from(address, base ? *base : probable_base(address))) return;
  }
  throw std::system_error(EADDRINUSE, std::generic_category(), "ports of the controller on " + address);
}

bool Server::listen_from(const std::string& address, std::uint16_t base) {
  ports_.clear();
  try {
    dashboard_ = listen_on({address, static_cast<std::uint16_t>(base - 1)});
    rtde_ = listen_on({address, static_cast<std::uint16_t>(base + 4)});
    for (const Offset& offset : kOffsets) {
      const auto port = static_cast<std::uint16_t>(base + offset.port);
      ports_.push_back({listen_on({address, port}), offset.primary, offset.read_only});
    }
  } catch (const std::system_error& error) {
    if (error.code().value() != EADDRINUSE) throw;
    return false;
  }
  return true;
}

void Server::add_to_poll(std::vector<pollfd>& polled) {
  poll_begin_ = polled.size();
  for (const Port& port : ports_) polled.push_back({port.listener.get(), POLLIN, 0});
  for (const Client& client : clients_) polled.push_back(client.polled());
}

std::vector<std::string> Server::serve(const std::vector<pollfd>& polled) {
  std::vector<std::string> scripts;
  std::size_t at = poll_begin_ + ports_.size();
  for (Client& client : clients_) {
    const short found = polled[at++].revents;
    if (found & POLLOUT) client.flush();
    if (!client.gone && (found & (POLLIN | POLLHUP | POLLERR))) read_from(client, scripts);
  }
  forget_gone();
  for (std::size_t i = 0; i < ports_.size(); ++i) {
    if (polled[poll_begin_ + i].revents & POLLIN) accept_from(ports_[i]);
  }
  return scripts;
}

void Server::accept_from(const Port& port) {
  Fd socket = accept_client(port.listener);
  if (!socket) return;
  if (clients_.size() == kMostClients) {
    print_line("client_dropped too_many_clients");
    return;
  }
  Client client;
  client.socket = std::move(socket);
  client.primary = port.primary;
  client.read_only = port.read_only;
  clients_.push_back(std::move(client));
}

void Server::read_from(Client& client, std::vector<std::string>& scripts) {
  std::string bytes;
  const Transfer transfer = read_some(client.socket, bytes, 16384);
  client.gone = transfer.kind == Transfer::Kind::closed;
  // Input on a read-only port is read, so that the client can close in order, and discarded.
  if (client.read_only) return;
  for (std::string& script : client.intake.take(bytes)) scripts.push_back(std::move(script));
  if (!client.intake.fault().empty()) client.drop(client.intake.fault());
}

void Server::greet(std::string_view packets) {
  for (Client& client : clients_) {
    if (client.greeted) continue;
    client.greeted = true;
    queue(client, packets);
  }
  forget_gone();
}

void Server::send(std::string_view packet, bool primary_only) {
  for (Client& client : clients_) {
    if (client.primary || !primary_only) queue(client, packet);
  }
  forget_gone();
}

void Server::queue(Client& client, std::string_view packet) {
  if (client.gone) return;
  client.output += packet;
  client.flush();
  if (client.output.size() > kLargestOutput) client.drop("does_not_read");
}

void Server::forget_gone() {
  std::erase_if(clients_, [](const Client& client) { return client.gone; });
}

}  // namespace trb::virtual_robots::ur
