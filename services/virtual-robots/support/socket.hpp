#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

namespace trb::virtual_robots {

/** Owns a file descriptor. */
class Fd {
 public:
  Fd() = default;
  explicit Fd(int fd) : fd_(fd) {}
  Fd(Fd&& other) noexcept;
  Fd& operator=(Fd&& other) noexcept;
  Fd(const Fd&) = delete;
  Fd& operator=(const Fd&) = delete;
  ~Fd();

  int get() const { return fd_; }
  explicit operator bool() const { return fd_ >= 0; }
  void reset();

 private:
  int fd_ = -1;
};

struct Endpoint {
  std::string address;
  std::uint16_t port = 0;
};

/** `ADDRESS:PORT`, a numeric IPv4 address. */
std::optional<Endpoint> parse_endpoint(std::string_view text);

/** A listening, non-blocking socket; port 0 lets the system choose. Throws std::system_error. */
Fd listen_on(const Endpoint& where);

/** A bound, non-blocking UDP socket; port 0 lets the system choose. Throws std::system_error. */
Fd bind_datagrams(const Endpoint& where);

std::uint16_t port_of(const Fd& socket);

/** The next client of a listening socket, non-blocking; empty when there is none. */
Fd accept_client(const Fd& listener);

/** Starts to connect without waiting; an empty `from` leaves the source address to the system. Throws. */
Fd start_connect(const Endpoint& to, const std::string& from);

/** Call it once a connecting socket is writable: 0, or the errno of the failure. */
int connect_result(const Fd& socket);

/** Outcome of one read or write. */
struct Transfer {
  enum class Kind { done, later, closed };
  Kind kind = Kind::later;
  std::size_t bytes = 0;
};

Transfer read_some(const Fd& socket, std::string& into, std::size_t most);
Transfer write_some(const Fd& socket, std::string_view bytes);

}  // namespace trb::virtual_robots
