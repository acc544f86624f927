#include "services/virtual-robots/plc/server.hpp"

#include <utility>

namespace trb::virtual_robots::plc {
namespace {

constexpr std::size_t kMostClients = 16;
constexpr std::size_t kLargestOutput = std::size_t{64} * 1024;

}  // namespace

Server::Server(const Endpoint& where) : server_(where, kMostClients) {}

void Server::serve(const std::vector<pollfd>& polled, Memory& memory) {
  server_.serve(polled, [&](TcpServer::Client& client) { take(client, memory); });
  std::erase_if(intakes_, [&](const auto& entry) { return server_.find(entry.first) == nullptr; });
}

void Server::take(TcpServer::Client& client, Memory& memory) {
  Intake& intake = intakes_[client.id];
  const std::string answers = intake.take(std::exchange(client.input, {}), memory);
  server_.send(client, answers);
  if (client.gone) return;
  if (intake.broken()) client.drop("no_modbus");
  if (client.output.size() > kLargestOutput) client.drop("does_not_read");
}

}  // namespace trb::virtual_robots::plc
