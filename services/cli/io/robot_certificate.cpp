#include "services/cli/io/robot_certificate.hpp"

#include <arpa/inet.h>
#include <netinet/in.h>
#include <poll.h>
#include <sys/socket.h>

#include <array>
#include <cerrno>
#include <cstring>

#include "common/base/descriptor.hpp"
#include "common/transport/loop.hpp"

namespace trb::cli {
namespace {

constexpr Duration kPatience = std::chrono::seconds(5);

class Look {
 public:
  Look(std::string place, TlsClient& client) : place_(std::move(place)), client_(client) {}

  Status dial(const sockaddr_in& to) {
    fd_ = Descriptor(::socket(AF_INET, SOCK_STREAM | SOCK_NONBLOCK | SOCK_CLOEXEC, 0));
    if (!fd_) return lost();
    if (::connect(fd_.get(), reinterpret_cast<const sockaddr*>(&to), sizeof to) != 0 && errno != EINPROGRESS)
      return lost();
    if (const Status there = wait(POLLOUT); !there) return there;
    int problem = 0;
    socklen_t size = sizeof problem;
    ::getsockopt(fd_.get(), SOL_SOCKET, SO_ERROR, &problem, &size);
    errno = problem;
    return problem == 0 ? Status(Done{}) : Status(lost());
  }

  /// Until the handshake is over, whatever its end.
  Status shake_hands() {
    auto taken = client_.take({});
    while (taken && !client_.ready()) {
      if (const Status sent = send(); !sent) return sent;
      if (const Status there = wait(POLLIN); !there) return there;
      const ssize_t got = ::recv(fd_.get(), buffer_.data(), buffer_.size(), 0);
      if (got < 0) return lost();
      if (got == 0)
        return fail(Errc::malformed, place_ + ": the robot ended the handshake", "is it the port for HTTPS?");
      taken = client_.take({buffer_.data(), static_cast<std::size_t>(got)});
    }
    (void)send();  // the last word, or why there is none
    return taken ? Status(Done{}) : Status(taken.error());
  }

 private:
  [[nodiscard]] Error lost() const {
    return fail(Errc::io_error, place_ + ": " + std::strerror(errno),
                "look at robot.host in node.json, at the port in commands.json, and at the robot's power and cable");
  }
  Status wait(short events) {
    const auto left = std::chrono::duration_cast<std::chrono::milliseconds>(until_ - read_clocks().mono);
    pollfd one{fd_.get(), events, 0};
    if (left.count() > 0 && ::poll(&one, 1, static_cast<int>(left.count())) > 0) return Done{};
    return fail(Errc::timeout, place_ + ": no answer within 5 s",
                "look at robot.host in node.json, at the port in commands.json, and at the robot's power and cable");
  }
  /// A handshake fits into the socket's buffer.
  Status send() {
    const Bytes bytes = client_.to_send();
    const bool done = ::send(fd_.get(), bytes.data(), bytes.size(), MSG_NOSIGNAL) == static_cast<ssize_t>(bytes.size());
    return done ? Status(Done{}) : Status(lost());
  }

  std::string place_;
  TlsClient& client_;
  Descriptor fd_;
  MonotonicTime until_ = read_clocks().mono + kPatience;
  std::array<char, 16384> buffer_{};
};

}  // namespace

Result<ShownCertificate> look_at_certificate(const std::string& host, std::uint16_t port, const TlsTrust& trust) {
  sockaddr_in to{};
  to.sin_family = AF_INET;
  to.sin_port = htons(port);
  if (::inet_pton(AF_INET, host.c_str(), &to.sin_addr) != 1)
    return fail(Errc::bad_value, "robot.host: '" + host + "' is no IPv4 address", "write four numbers into node.json");
  const auto client = TlsClient::make(trust);
  if (!client) return client.error();
  Look look(host + ":" + std::to_string(port), **client);
  if (const Status dialled = look.dial(to); !dialled) return dialled.error();
  const Status shaken = look.shake_hands();
  if (!shaken && !(*client)->certificate()) return shaken.error();
  return ShownCertificate{*(*client)->certificate(), shaken ? std::nullopt : std::optional(shaken.error())};
}

}  // namespace trb::cli
