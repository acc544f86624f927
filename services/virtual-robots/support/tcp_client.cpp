#include "services/virtual-robots/support/tcp_client.hpp"

#include "services/virtual-robots/support/process.hpp"

namespace trb::virtual_robots {

pollfd TcpClient::polled() const {
  const int events = output.empty() ? POLLIN : POLLIN | POLLOUT;
  return {socket.get(), static_cast<short>(events), 0};
}

void TcpClient::flush() {
  if (output.empty()) return;
  const Transfer transfer = write_some(socket, output);
  if (transfer.kind == Transfer::Kind::closed) gone = true;
  output.erase(0, transfer.bytes);
}

void TcpClient::drop(std::string_view reason) {
  gone = true;
  print_line("client_dropped " + std::string(reason));
}

}  // namespace trb::virtual_robots
