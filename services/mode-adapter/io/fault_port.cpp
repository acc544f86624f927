#include "services/mode-adapter/io/fault_port.hpp"

#include <arpa/inet.h>
#include <sys/socket.h>

#include <cerrno>
#include <cstdlib>
#include <cstring>

#include "services/mode-adapter/io/tcp.hpp"

namespace trb::adapter {

Status send_control_line(const std::string& where, const std::string& line) {
  const std::size_t colon = where.rfind(':');
  sockaddr_in to{};
  to.sin_family = AF_INET;
  to.sin_port = htons(static_cast<std::uint16_t>(std::atoi(where.c_str() + colon + 1)));
  inet_pton(AF_INET, where.substr(0, colon).c_str(), &to.sin_addr);
  const Descriptor socket(::socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC | SOCK_NONBLOCK, 0));
  const auto sent =
      ::sendto(socket.get(), line.data(), line.size(), 0, reinterpret_cast<const sockaddr*>(&to), sizeof to);
  if (sent >= 0) return Done{};
  return fail(Errc::io_error, "the virtual robot's control port " + where + ": " + std::strerror(errno),
              "look at \"fault_injection\" in node.json and at the virtual robot's --control");
}

}  // namespace trb::adapter
