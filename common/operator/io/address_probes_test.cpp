// What is tried on addresses, on real sockets of this machine.
#include "common/operator/io/address_probes.hpp"

#include <arpa/inet.h>
#include <netinet/in.h>
#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

#include "common/config/interfaces.hpp"
#include "common/operator/io/socket_address.hpp"
#include "common/operator/io/test/played_router.hpp"

using namespace trb;
using namespace trb::op;

namespace {

/// A port of this machine that accepts a connection, and sends `greeting` on it.
class Listener {
 public:
  explicit Listener(std::string greeting = {}) : greeting_(std::move(greeting)) {
    fd_ = ::socket(AF_INET, SOCK_STREAM | SOCK_NONBLOCK | SOCK_CLOEXEC, 0);
    sockaddr_in at{};
    at.sin_family = AF_INET;
    at.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    REQUIRE(::bind(fd_, reinterpret_cast<const sockaddr*>(&at), sizeof at) == 0);
    REQUIRE(::listen(fd_, 8) == 0);
    socklen_t size = sizeof at;
    ::getsockname(fd_, reinterpret_cast<sockaddr*>(&at), &size);
    address_ = "127.0.0.1:" + std::to_string(ntohs(at.sin_port));
  }
  ~Listener() {
    close();
    if (client_ >= 0) ::close(client_);
  }
  Listener(const Listener&) = delete;
  Listener& operator=(const Listener&) = delete;

  /// It was dialled; nobody's loop needs to turn for that.
  [[nodiscard]] bool accept() {
    pollfd dialled{fd_, POLLIN, 0};
    if (::poll(&dialled, 1, 60'000) != 1) return false;
    client_ = ::accept4(fd_, nullptr, nullptr, SOCK_CLOEXEC);
    if (client_ >= 0 && !greeting_.empty()) REQUIRE(::send(client_, greeting_.data(), greeting_.size(), 0) == 1);
    return client_ >= 0;
  }
  void close() {
    if (fd_ >= 0) ::close(fd_);
    fd_ = -1;
  }
  [[nodiscard]] AddressProbe probe() const {
    AddressProbe out;
    out.address = address_;
    return out;
  }

 private:
  std::string greeting_;
  std::string address_;
  int fd_ = -1;
  int client_ = -1;
};

AddressProbe probe_of(const std::string& address) {
  AddressProbe out;
  out.address = address;
  return out;
}

}  // namespace

TEST_CASE("a port is a router's, another's, closed, or at no address; all are tried at once, for a second and a half") {
  Loop loop;
  AddressProbes probes(loop);
  Listener router("\xff");
  Listener other("S");
  Listener silent;
  Listener also_silent;
  Listener closed;
  closed.close();
  std::optional<std::vector<AddressProbe>> seen;
  constexpr Duration kWait = std::chrono::milliseconds(1500);
  const MonotonicTime before = read_clocks().mono;
  probes.try_ports(
      {router.probe(), other.probe(), silent.probe(), also_silent.probe(), closed.probe(), probe_of("bee")},
      [&](std::vector<AddressProbe> all) { seen = std::move(all); });
  const MonotonicTime after = read_clocks().mono;
  CHECK_FALSE(seen.has_value());
  for (Listener* each : {&router, &other, &silent, &also_silent}) CHECK(each->accept());
  const auto end = loop.next_deadline();
  REQUIRE(end);
  CHECK(*end >= before + kWait);
  CHECK(*end <= after + kWait);
  while (!seen) loop.turn();
  REQUIRE(seen->size() == 6);
  CHECK((*seen)[0].port == Port::zmtp);
  CHECK((*seen)[1].port == Port::not_zmtp);
  CHECK((*seen)[2].port == Port::not_zmtp);
  CHECK((*seen)[3].port == Port::not_zmtp);
  CHECK((*seen)[4].port == Port::refused);
  CHECK((*seen)[5].port == Port::no_route);
}

TEST_CASE("an address of IPv6 stands in brackets, as join_host_port() writes it") {
  const auto at = socket_address(join_host_port("fd00::1", 45000));
  REQUIRE(at);
  CHECK(at->family() == AF_INET6);
  CHECK(socket_address(join_host_port("fe80::1%lo", 45000)));
  CHECK_FALSE(socket_address("fd00::1:45000"));
}

TEST_CASE("without an address the call comes at the next turn, and may begin the next") {
  Loop loop;
  AddressProbes probes(loop);
  int calls = 0;
  probes.try_ports({}, [&](const std::vector<AddressProbe>& none) {
    CHECK(none.empty());
    ++calls;
    probes.try_datagrams({probe_of("nobody")}, [&](const std::vector<AddressProbe>& all) {
      CHECK(all[0].large == LargeDatagram::not_known);
      ++calls;
    });
  });
  CHECK(calls == 0);
  while (calls < 2) loop.turn();
}

TEST_CASE("datagrams of both sizes reach this machine, which says that nobody listens") {
  Loop loop;
  AddressProbes probes(loop);
  std::optional<std::vector<AddressProbe>> seen;
  probes.try_datagrams({probe_of("127.0.0.1:45000")}, [&](std::vector<AddressProbe> all) { seen = std::move(all); });
  while (!seen) loop.turn();
  CHECK((*seen)[0].large == LargeDatagram::passed);
}

TEST_CASE("what was under way when it ends is dropped") {
  Loop loop;
  const Listener silent;
  {
    AddressProbes probes(loop);
    probes.try_ports({silent.probe()}, [](const std::vector<AddressProbe>&) { FAIL("called back"); });
  }
  CHECK_FALSE(loop.next_deadline().has_value());
}

TEST_CASE(
    "the link to the router is kept alive while addresses are tried, so that the first echo behind them is heard") {
  PlayedRouter node;
  auto bus = BusSession::open("cli");
  REQUIRE(bus.ok());
  node.expect(**bus, ServiceHello::kSubtype);
  node.send(ServiceWelcome{"ant", "robot", 1, 1, 1});
  REQUIRE(PlayedRouter::turn_until(**bus, [&] { return (*bus)->is_up(); }));

  // Silent ports, three times: longer than the router's lease of three seconds.
  AddressProbes probes((*bus)->loop());
  const Listener silent;
  int alive = 0;
  for (int round = 0; round < 3; ++round) {
    bool done = false;
    probes.try_ports({silent.probe()}, [&](const std::vector<AddressProbe>&) { done = true; });
    while (!done) {
      PlayedRouter::turn(**bus);
      const auto message = node.receive();
      if (!message || message->subtype != ServiceAlive::kSubtype) continue;
      ++alive;
      node.send(ServiceAliveSeen{});
    }
  }
  CHECK(alive >= 3);

  std::optional<bool> echoed;
  (*bus)->session().request(Send{.type = MessageType::request, .target = "ant", .body = EchoRequest{{"e"}}},
                            [&](const Result<Message>& answer) { echoed = answer.ok(); });
  PlayedRouter::turn(**bus);
  CHECK((*bus)->is_up());
  const Message question = node.expect(**bus, EchoRequest::kSubtype);
  node.send(Echo{{"e"}}, question.id);
  REQUIRE(PlayedRouter::turn_until(**bus, [&] { return echoed.has_value(); }));
  CHECK(*echoed);
}
