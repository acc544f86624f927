// Connections that are cut for messages without a last part, over loopback: the clients speak ZMTP 3 without CURVE by
// hand, because libzmq sends no part before the last.
#include "services/router/io/inbox_guard.hpp"

#include <arpa/inet.h>
#include <doctest/doctest.h>
#include <netinet/in.h>
#include <sys/socket.h>

#include <deque>

#include "common/base/descriptor.hpp"
#include "common/transport/socket.hpp"

using namespace trb;
using namespace trb::router;

namespace {

constexpr std::size_t kMebibyte = 1U << 20U;

/// A connection of a DEALER that sends parts.
class Client {
 public:
  explicit Client(std::uint16_t port) : stream_(::socket(AF_INET, SOCK_STREAM, 0)) {
    sockaddr_in to{};
    to.sin_family = AF_INET;
    to.sin_port = htons(port);
    to.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    REQUIRE(::connect(stream_.get(), reinterpret_cast<const sockaddr*>(&to), sizeof to) == 0);
    put(Bytes("\xff\0\0\0\0\0\0\0\0\x7f\x03\0NULL", 16) + Bytes(48, '\0'));
    const Bytes kind(
        "\x05READY\x0bSocket-Type\0\0\0\x06"
        "DEALER",
        28);
    put(Bytes{'\x04', static_cast<char>(kind.size())} + kind);
    // Its greeting, and its READY: before that it takes no message.
    get(64);
    get(static_cast<std::size_t>(get(2)[1]));
  }
  void send(std::size_t size, bool more) {
    Bytes head{static_cast<char>(more ? 3 : 2)};
    for (int shift = 56; shift >= 0; shift -= 8) head += static_cast<char>(size >> static_cast<unsigned>(shift));
    put(head + Bytes(size, 'x'));
    sent_ += size;
  }
  [[nodiscard]] std::size_t sent() const { return sent_; }
  /// Has the other side ended it? Waits for that.
  bool is_ended() {
    char rest[256];
    ssize_t got = 1;
    while (got > 0) got = ::recv(stream_.get(), rest, sizeof rest, 0);
    return got == 0;
  }

 private:
  Bytes get(std::size_t size) {
    Bytes bytes(size, '\0');
    REQUIRE(::recv(stream_.get(), bytes.data(), size, MSG_WAITALL) == static_cast<ssize_t>(size));
    return bytes;
  }
  void put(const Bytes& bytes) {
    REQUIRE(::send(stream_.get(), bytes.data(), bytes.size(), MSG_NOSIGNAL) == static_cast<ssize_t>(bytes.size()));
  }
  Descriptor stream_;
  std::size_t sent_ = 0;
};

struct Door {
  Context context;
  Loop loop;
  std::vector<PendingConnectionId> cut;
  InboxGuard guard{loop, {}, [](const std::string&) {}, [](const std::string&) {}};
  Socket socket = *Socket::bus_server(context, "");
  int fd = -1;  ///< of the last connection
  std::unique_ptr<SocketMonitor> monitor =
      *SocketMonitor::watch(context, loop, socket, [this](LinkEvent event, int of) { on_event(event, of); });

  Door() {
    guard.set_on_incomplete([this](PendingConnectionId pending, const std::string&) { cut.push_back(pending); });
    loop.add_timer([] { return std::optional(read_clocks().mono + std::chrono::milliseconds(2)); }, [](Now) {});
    REQUIRE(socket.bind("tcp://127.0.0.1:*").ok());
  }
  void on_event(LinkEvent event, int of) {
    if (event == LinkEvent::accepted) fd = of;
    guard.on_event(event, of);
  }
  [[nodiscard]] std::uint16_t port() const {
    const std::string endpoint = socket.last_endpoint();
    return static_cast<std::uint16_t>(std::stoi(endpoint.substr(endpoint.rfind(':') + 1)));
  }
  template <class Condition>
  bool turn_until(Condition condition) {
    const MonotonicTime end = read_clocks().mono + std::chrono::seconds(60);
    while (!condition()) {
      if (read_clocks().mono > end) return false;
      loop.turn();
    }
    return true;
  }
  /// libzmq has read all of it.
  void let_read(const Client& client) {
    REQUIRE(turn_until([&] { return fd >= 0 && bytes_read(fd).value_or(0) >= client.sent(); }));
  }
  /// Receives so many messages, or what there is; returns how many.
  std::size_t take(IncompleteBytes& of, std::size_t most) {
    Frame routing_id;
    Frame frame;
    std::size_t taken = 0;
    for (; taken < most && socket.receive(routing_id) && socket.receive(frame); ++taken) {
      of.add(frame.size());
      of.add_on_wire(socket.skip_rest(frame));
    }
    return taken;
  }
};

}  // namespace

TEST_CASE("given complete messages that wait for a loop that is behind, then their connection is not cut") {
  Door door;
  Client client(door.port());
  for (int i = 0; i < 20; ++i) client.send(kMebibyte, false);
  door.let_read(client);
  const auto received = door.guard.carries(door.guard.pending(door.fd));
  REQUIRE(door.guard.look());
  std::size_t taken = 0;
  REQUIRE(door.turn_until([&] { return (taken += door.take(*received, 20)) == 20; }));
  door.guard.on_empty();
  CHECK(door.cut.empty());
  CHECK_FALSE(door.guard.look());
}

TEST_CASE("given parts without end on a connection that carries messages, then it is cut once the socket is empty") {
  Door door;
  Client client(door.port());
  client.send(kMebibyte, false);
  for (int i = 0; i < 5; ++i) client.send(kMebibyte, true);
  door.let_read(client);
  const PendingConnectionId pending = door.guard.pending(door.fd);
  const auto received = door.guard.carries(pending);
  REQUIRE(door.guard.look());
  CHECK(door.cut.empty());
  REQUIRE(door.turn_until([&] { return door.take(*received, 20) == 1; }));
  door.guard.on_empty();
  CHECK(door.cut == std::vector{pending});
  CHECK(client.is_ended());
  CHECK(door.turn_until([&] { return door.guard.pending(door.fd) == 0; }));
}

TEST_CASE("given a socket that is never empty, then parts without end are found after enough messages of others") {
  Door door;
  Client client(door.port());
  for (int i = 0; i < 5; ++i) client.send(kMebibyte, true);
  door.let_read(client);
  (void)door.guard.carries(door.guard.pending(door.fd));
  REQUIRE(door.guard.look());
  for (int turn = 0; turn < 3; ++turn) door.guard.on_turn(kTurnMessages);
  CHECK(door.cut.empty());
  door.guard.on_turn(kTurnMessages);
  CHECK(door.cut.size() == 1);
}

TEST_CASE("given connections that are looked at in parts, then each part cuts its own alone") {
  Door door;
  std::deque<Client> clients;
  for (std::size_t i = 1; i <= 3; ++i) {
    door.fd = -1;
    Client& client = clients.emplace_back(door.port());
    client.send(kMostUnproven, true);
    door.let_read(client);
  }
  for (std::size_t part = 0; part < 3; ++part) {
    door.guard.look(0, {part, 3});
    CHECK(door.cut.size() == part + 1);
  }
}

TEST_CASE("given a connection that is suspected, then others are looked at all the same, each for its own messages") {
  Door door;
  std::deque<Client> clients;
  for (int i = 0; i < 2; ++i) {
    door.fd = -1;
    Client& client = clients.emplace_back(door.port());
    for (int piece = 0; piece < 5; ++piece) client.send(kMebibyte, true);
    door.let_read(client);
    (void)door.guard.carries(door.guard.pending(door.fd));
  }
  REQUIRE(door.guard.look(0, {0, 2}));
  for (int turn = 0; turn < 5; ++turn) door.guard.on_turn(kTurnMessages);
  REQUIRE(door.guard.look(0, {1, 2}));
  CHECK(door.cut.empty());
  door.guard.on_turn(kTurnMessages);
  CHECK(door.cut.size() == 1);
  for (int turn = 0; turn < 6; ++turn) door.guard.on_turn(kTurnMessages);
  CHECK(door.cut.size() == 2);
}

TEST_CASE("given parts that come to an end, then they count as received") {
  Door door;
  Client client(door.port());
  for (int i = 0; i < 5; ++i) client.send(kMebibyte, true);
  client.send(kMebibyte, false);
  door.let_read(client);
  const auto received = door.guard.carries(door.guard.pending(door.fd));
  REQUIRE(door.guard.look());
  REQUIRE(door.turn_until([&] { return door.take(*received, 20) == 1; }));
  door.guard.on_empty();
  CHECK(door.cut.empty());
}

TEST_CASE("given a connection that is no link yet, then it is cut at once over 64 KiB, complete or not") {
  Door door;
  Client client(door.port());
  client.send(kMostUnproven / 2, false);
  door.let_read(client);
  door.guard.look();
  CHECK(door.cut.empty());
  client.send(kMostUnproven / 2, true);
  door.let_read(client);
  door.guard.look();
  CHECK(door.cut.size() == 1);
  CHECK(client.is_ended());
}

TEST_CASE("given a connection that has had its Goodbye, then it is not counted a second time") {
  Door door;
  Client client(door.port());
  client.send(kMebibyte, true);
  door.let_read(client);
  door.guard.leave(door.guard.pending(door.fd));
  door.guard.look();
  CHECK(door.cut.empty());
}

TEST_CASE("given a bus, then each connection carries messages, and its heartbeats are not missing") {
  Door door;
  door.guard.all_carry();
  Client client(door.port());
  for (int i = 0; i < 3; ++i) client.send(kMebibyte - 1024, true);
  door.let_read(client);
  CHECK_FALSE(door.guard.look());
  client.send(kMebibyte, true);
  door.let_read(client);
  CHECK_FALSE(door.guard.look(std::uint64_t{1} << 40U));
  CHECK(door.guard.look());
  door.guard.on_empty();
  CHECK(door.cut.size() == 1);
}
