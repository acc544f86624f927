#include "services/router/io/metrics_port.hpp"

#include <arpa/inet.h>
#include <doctest/doctest.h>
#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

#include <memory>

using namespace trb;
using namespace trb::router;

namespace {

std::string text() {
  return "trb_node_boot 7\n";
}

std::string status_of(const std::string& request) {
  const std::string reply = metrics_reply(request, "127.0.0.1:9464", text);
  return reply.substr(0, reply.find("\r\n"));
}

/// Nobody else's connections are there.
constexpr const char* kAddress = "127.0.26.3";

/// A port with its own loop, at a free port of the address.
struct Port {
  Port() {
    for (int tries = 1; !open(); ++tries) REQUIRE(tries < 100);
  }
  /// False: somebody took the port just now.
  bool open() {
    const int probe = ::socket(AF_INET, SOCK_STREAM, 0);
    sockaddr_in any{};
    any.sin_family = AF_INET;
    REQUIRE(::inet_pton(AF_INET, kAddress, &any.sin_addr) == 1);
    socklen_t size = sizeof any;
    REQUIRE(::bind(probe, reinterpret_cast<sockaddr*>(&any), sizeof any) == 0);
    REQUIRE(::getsockname(probe, reinterpret_cast<sockaddr*>(&any), &size) == 0);
    ::close(probe);
    at = any;
    port = std::make_unique<MetricsPort>(loop, [] { return std::string(1'000'000, 'x') + "\n"; });
    return port->open({kAddress, ntohs(any.sin_port)}).ok();
  }
  int dial() {
    const int fd = ::socket(AF_INET, SOCK_STREAM, 0);
    REQUIRE(::connect(fd, reinterpret_cast<sockaddr*>(&at), sizeof at) == 0);
    loop.handle_ready();
    return fd;
  }
  void say(int fd, const std::string& request) {
    REQUIRE(::send(fd, request.data(), request.size(), MSG_NOSIGNAL) == static_cast<ssize_t>(request.size()));
  }
  /// All that is said until it is closed.
  std::string answer(int fd) {
    std::string out;
    char buffer[65536];
    const MonotonicTime end = read_clocks().mono + std::chrono::seconds(60);
    while (read_clocks().mono < end) {
      loop.handle_ready();
      const ssize_t size = ::recv(fd, buffer, sizeof buffer, MSG_DONTWAIT);
      if (size == 0 || (size < 0 && errno != EAGAIN)) break;
      if (size > 0) out.append(buffer, static_cast<std::size_t>(size));
    }
    ::close(fd);
    return out;
  }
  [[nodiscard]] std::string request() const {
    return "GET /metrics HTTP/1.1\r\nHost: " + std::string(kAddress) + ":" + std::to_string(ntohs(at.sin_port)) +
           "\r\n\r\n";
  }

  Loop loop;
  std::unique_ptr<MetricsPort> port;
  sockaddr_in at{};
};

}  // namespace

TEST_CASE("metrics port: what is asked, and what is not") {
  const std::string host = "Host: 127.0.0.1:9464\r\n\r\n";
  CHECK(status_of("GET /metrics HTTP/1.1\r\n" + host) == "HTTP/1.1 200 OK");
  CHECK(status_of("GET /metrics HTTP/1.1\r\nHost: localhost:9464\r\n\r\n") == "HTTP/1.1 200 OK");
  CHECK(status_of("GET /metrics HTTP/1.1\r\nHost: evil.example:9464\r\n\r\n") == "HTTP/1.1 403 Forbidden");
  CHECK(status_of("GET /metrics HTTP/1.1\r\n\r\n") == "HTTP/1.1 403 Forbidden");
  CHECK(status_of("GET / HTTP/1.1\r\n" + host) == "HTTP/1.1 404 Not Found");
  CHECK(status_of("POST /metrics HTTP/1.1\r\nContent-Length: 0\r\n" + host) == "HTTP/1.1 405 Method Not Allowed");
  CHECK(status_of("nonsense\r\n\r\n") == "HTTP/1.1 400 Bad Request");
  CHECK(status_of("GET /metrics HTTP/1.1\r\nHost: 127").empty());
}

TEST_CASE("metrics port: a long answer comes whole, to a request that comes in pieces") {
  Port port;
  const int fd = port.dial();
  const std::string request = port.request();
  port.say(fd, request.substr(0, 10));
  port.loop.handle_ready();
  port.say(fd, request.substr(10));
  const std::string said = port.answer(fd);
  CHECK(said.starts_with("HTTP/1.1 200 OK\r\n"));
  CHECK(said.size() > 1'000'000);
  CHECK(said.ends_with("x\n"));
}

TEST_CASE("metrics port: who holds all connections open, or writes without end, keeps nobody out") {
  Port port;
  std::vector<int> held;
  for (std::size_t i = 0; i < 3 * MetricsPort::kMost; ++i) held.push_back(port.dial());
  const int talker = port.dial();
  port.say(talker, "GET /" + std::string(MetricsPort::kMostBytes + 100, 'a'));
  CHECK(port.answer(talker).find("200 OK") == std::string::npos);
  const int fd = port.dial();
  port.say(fd, port.request());
  CHECK(port.answer(fd).starts_with("HTTP/1.1 200 OK\r\n"));
  for (const int one : held) ::close(one);
}

TEST_CASE("metrics port: an address that another has is named") {
  Port port;
  MetricsPort second(port.loop, text);
  const Status opened = second.open({kAddress, ntohs(port.at.sin_port)});
  REQUIRE_FALSE(opened.ok());
  CHECK(opened.error().what.find("metrics.json") != std::string::npos);
}
