// Connections of datagrams over real loopback sockets: every wait is a poll with a deadline.
#include <arpa/inet.h>
#include <netinet/in.h>
#include <sys/socket.h>

#include "common/drivers/udp-at/test/fixture.hpp"
#include "services/mode-adapter/io/udp.hpp"
#include "services/mode-adapter/test/fake_service.hpp"

using namespace trb;
using namespace trb::adapter;

namespace {

/// A drone's own address: the node's sockets have no port there.
constexpr const char* kDrone = "127.0.27.2";

/// A drone's socket, bound to a port of its address.
struct DroneSocket {
  struct Unbound {};
  explicit DroneSocket(Unbound) : fd(::socket(AF_INET, SOCK_DGRAM | SOCK_NONBLOCK | SOCK_CLOEXEC, 0)) {}
  DroneSocket() : DroneSocket(Unbound{}) { REQUIRE(bind_to(0)); }
  /// 0: any free one. False: it is taken.
  bool bind_to(std::uint16_t at) {
    sockaddr_in where{};
    where.sin_family = AF_INET;
    where.sin_port = htons(at);
    inet_pton(AF_INET, kDrone, &where.sin_addr);
    const bool is_bound = ::bind(fd.get(), reinterpret_cast<sockaddr*>(&where), sizeof where) == 0;
    port = local_port(fd.get());
    return is_bound;
  }
  /// True if a datagram has come; `last` holds it then.
  bool heard() {
    char buffer[4096];
    socklen_t length = sizeof peer;
    const ssize_t size = ::recvfrom(fd.get(), buffer, sizeof buffer, 0, reinterpret_cast<sockaddr*>(&peer), &length);
    if (size >= 0) last.assign(buffer, static_cast<std::size_t>(size));
    return size >= 0;
  }
  void say(const std::string& packet) {
    CHECK(::sendto(fd.get(), packet.data(), packet.size(), 0, reinterpret_cast<sockaddr*>(&peer), sizeof peer) ==
          ssize_t(packet.size()));
  }

  Descriptor fd;
  std::uint16_t port = 0;
  sockaddr_in peer{};
  std::string last;
};

struct DroneNode {
  DroneNode(std::uint16_t commands, std::uint16_t monitor)
      : core(
            drone(), [](bool) { return Status(Done{}); }, [](const std::vector<Kept>&) { return Status(Done{}); }),
        io(*RobotIo::open({kLoopback, 0, kDrone, commands, monitor, true}, service, core)) {
    service.after_sends([this] { io->carry_out(core.take_robot_output()); });
    service.timer([this] { return core.next_deadline(); },
                  [this](Now) { service.step([this](Now at, Outbox& out) { core.tick(at, out); }); });
  }

  FakeService service;
  ModeAdapterCore core;
  std::unique_ptr<RobotIo> io;
};

bool online(DroneNode& node) {
  std::string state;
  node.service.step([&](Now at, Outbox& out) {
    node.core.on({MessageType::request, "drone", "", 1, 0, 0, 1000, AdapterStateRequest{}}, at, out);
    state = sent<AdapterState>(out).at(0).robot;
  });
  return state == "ONLINE";
}

}  // namespace

TEST_CASE("io: a drone is woken, heard and commanded by datagrams; each write is one") {
  DroneSocket commands;
  DroneSocket monitor;
  DroneNode node(commands.port, monitor.port);
  REQUIRE(node.service.until([&] { return monitor.heard(); }));
  CHECK(monitor.last == std::string("\1\0\0\0", 4));
  monitor.say("");  // an empty datagram does not end the connection
  monitor.say(navdata(1, kOnGround));
  REQUIRE(node.service.until([&] { return online(node); }));
  REQUIRE(node.service.until([&] { return commands.heard(); }));
  CHECK(commands.last == "AT*REF=1,290717696\rAT*PCMD=2,0,0,0,0,0\r");
}

TEST_CASE("io: a host that has nobody on the port is told as down, and the drone that comes is found") {
  std::uint16_t free_port = DroneSocket().port;
  DroneSocket commands;
  DroneNode node(commands.port, free_port);
  REQUIRE(node.service.until([&] { return node.service.logged("robot_lost") > 0; }));
  DroneSocket monitor(DroneSocket::Unbound{});
  REQUIRE(node.service.until([&] { return monitor.bind_to(free_port); }));
  REQUIRE(node.service.until([&] { return monitor.heard(); }));
  monitor.say(navdata(1, kOnGround));
  REQUIRE(node.service.until([&] { return online(node); }));
  CHECK(node.service.logged("robot_lost") == 1);  // not once for each try
  monitor.fd.reset();
  commands.fd.reset();
  REQUIRE(node.service.until([&] { return !online(node); }));
}

TEST_CASE("io: a robot's host that is no address is said, again and again in vain") {
  CHECK(udp_dial("drone", 5556).error().code == Errc::bad_value);
}
