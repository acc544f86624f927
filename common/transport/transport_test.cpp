// The loop, CURVE with ZAP, monitors: over real sockets of this machine.
#include <doctest/doctest.h>
#include <netinet/in.h>
#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <csignal>
#include <set>

#include "common/base/descriptor.hpp"
#include "common/base/hex.hpp"
#include "common/security/keys.hpp"
#include "common/transport/loop.hpp"
#include "common/transport/monitor.hpp"
#include "common/transport/signals.hpp"
#include "common/transport/socket.hpp"
#include "common/transport/test/no_descriptors.hpp"
#include "common/transport/zap.hpp"

using namespace trb;

namespace {

CurveKeys make_keys() {
  const LinkKey key = make_link_key();
  return {key.public_key, key.secret_key};
}

/// Turns the loop until the condition holds; false after a minute.
template <class Condition>
bool turn_until(Loop& loop, Condition condition) {
  const MonotonicTime end = read_clocks().mono + std::chrono::seconds(60);
  // The sockets that a condition reads are not in the loop: it looks again every 10 ms.
  loop.add_timer([] { return std::optional(read_clocks().mono + std::chrono::milliseconds(10)); }, [](Now) {});
  while (read_clocks().mono < end) {
    if (condition()) return true;
    loop.turn();
  }
  return false;
}

struct GuardedInbox {
  Context context;
  Loop loop;
  CurveKeys server = make_keys();
  std::set<Bytes> members;
  ZapServer zap{context, loop, [this](BytesView, BytesView key) { return members.count(Bytes(key)) != 0; }};
  Socket inbox = *Socket::inbox(context, "tcp://127.0.0.1:*", server);
  std::vector<LinkEvent> events;
  int accepted_fd = -1;
  std::unique_ptr<SocketMonitor> watch = *SocketMonitor::watch(context, loop, inbox, [this](LinkEvent event, int fd) {
    if (event == LinkEvent::accepted) accepted_fd = fd;
    if (event != LinkEvent::accepted && event != LinkEvent::listening) events.push_back(event);
  });

  bool saw(LinkEvent event) const { return std::find(events.begin(), events.end(), event) != events.end(); }
};

struct Caller {
  CurveKeys keys = make_keys();
  Socket socket;
  std::vector<LinkEvent> events;
  std::unique_ptr<SocketMonitor> watch;

  Caller(GuardedInbox& guarded, BytesView server_key, bool member)
      : socket(*Socket::dialler(guarded.context, keys, server_key)),
        watch(*SocketMonitor::watch(guarded.context, guarded.loop, socket,
                                    [this](LinkEvent event, int) { events.push_back(event); })) {
    if (member) guarded.members.insert(keys.public_key);
    REQUIRE(socket.dial(guarded.inbox.last_endpoint()).ok());
  }
  bool saw(LinkEvent event) const { return std::find(events.begin(), events.end(), event) != events.end(); }
};

/// One connection to this port of 127.0.0.1 that ends at once. False: nobody took it for a second.
bool come_and_go(std::uint16_t port) {
  const Descriptor fd(::socket(AF_INET, SOCK_STREAM | SOCK_NONBLOCK | SOCK_CLOEXEC, 0));
  sockaddr_in at{};
  at.sin_family = AF_INET;
  at.sin_port = htons(port);
  at.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  (void)::connect(fd.get(), reinterpret_cast<const sockaddr*>(&at), sizeof at);
  pollfd made{fd.get(), POLLOUT, 0};
  return ::poll(&made, 1, 1000) == 1;
}

}  // namespace

TEST_CASE("a frame tells the descriptor of its connection, the one that the monitor told of") {
  GuardedInbox guarded;
  Caller caller{guarded, guarded.server.public_key, true};
  REQUIRE(turn_until(guarded.loop, [&] { return caller.saw(LinkEvent::connected); }));
  caller.socket.send(to_frame("hello"));
  Frame routing_id;
  Frame frame;
  REQUIRE(turn_until(guarded.loop, [&] { return guarded.inbox.receive(routing_id); }));
  REQUIRE(guarded.inbox.receive(frame));
  CHECK(guarded.accepted_fd >= 0);
  CHECK(connection_fd(frame) == guarded.accepted_fd);
}

TEST_CASE("a member's frames carry its key, and the answer finds the way back") {
  init_crypto();
  GuardedInbox guarded;
  Caller member(guarded, guarded.server.public_key, true);
  REQUIRE(turn_until(guarded.loop, [&] { return member.saw(LinkEvent::connected); }));
  CHECK(member.socket.send(to_frame("hello")) == SendResult::sent);
  Frame id;
  Frame word;
  REQUIRE(turn_until(guarded.loop, [&] { return guarded.inbox.receive(id) && guarded.inbox.receive(word); }));
  CHECK(view_of(word) == "hello");
  CHECK(user_id(word) == to_hex(member.keys.public_key));
  CHECK(guarded.inbox.send_to(view_of(id), to_frame("back")) == SendResult::sent);
  Frame back;
  REQUIRE(turn_until(guarded.loop, [&] { return member.socket.receive(back); }));
  CHECK(view_of(back) == "back");
}

TEST_CASE("a stranger's key and a wrong server key are told apart") {
  init_crypto();
  GuardedInbox guarded;
  Caller stranger(guarded, guarded.server.public_key, false);
  CHECK(turn_until(guarded.loop, [&] { return stranger.saw(LinkEvent::refused_key); }));
  Caller mistaken(guarded, make_keys().public_key, true);
  CHECK(turn_until(guarded.loop, [&] { return guarded.saw(LinkEvent::wrong_server_key); }));
  CHECK_FALSE(mistaken.saw(LinkEvent::connected));
}

TEST_CASE("a dialled link is never made again behind the core's back") {
  init_crypto();
  auto guarded = std::make_unique<GuardedInbox>();
  Context other;
  Loop loop;
  const CurveKeys keys = make_keys();
  guarded->members.insert(keys.public_key);
  Socket dialler = *Socket::dialler(other, keys, guarded->server.public_key);
  std::vector<LinkEvent> events;
  const auto watch =
      *SocketMonitor::watch(other, loop, dialler, [&](LinkEvent event, int) { events.push_back(event); });
  const std::string endpoint = guarded->inbox.last_endpoint();
  REQUIRE(dialler.dial(endpoint).ok());
  REQUIRE(turn_until(guarded->loop, [&] { return guarded->saw(LinkEvent::connected); }));
  const CurveKeys server = guarded->server;
  guarded.reset();
  REQUIRE(turn_until(loop, [&] { return !events.empty() && events.back() == LinkEvent::disconnected; }));
  GuardedInbox again;
  again.members.insert(keys.public_key);
  again.server = server;
  again.inbox = *Socket::inbox(again.context, endpoint, server);
  // The dead connection's queue goes a moment after the event; the successor gets nothing from it.
  CHECK(turn_until(again.loop, [&] { return dialler.send(to_frame("stale")) == SendResult::full; }));
  // Another's dial and frame arrive; of the first there is neither a frame before that, nor a second connection.
  const CurveKeys fresh_keys = make_keys();
  again.members.insert(fresh_keys.public_key);
  Socket fresh = *Socket::dialler(other, fresh_keys, server.public_key);
  bool is_fresh_up = false;
  const auto watch_fresh = *SocketMonitor::watch(
      other, loop, fresh, [&](LinkEvent event, int) { is_fresh_up = is_fresh_up || event == LinkEvent::connected; });
  REQUIRE(fresh.dial(endpoint).ok());
  REQUIRE(turn_until(again.loop, [&] {
    loop.handle_ready();
    return is_fresh_up;
  }));
  REQUIRE(fresh.send(to_frame("fresh")) == SendResult::sent);
  Frame id;
  Frame word;
  REQUIRE(turn_until(again.loop, [&] { return again.inbox.receive(id) && again.inbox.receive(word); }));
  CHECK(view_of(word) == "fresh");
  CHECK(std::count(events.begin(), events.end(), LinkEvent::connected) == 1);
}

TEST_CASE("a send to a connection that is gone is unroutable, a full one is refused") {
  Context context;
  const std::string endpoint = "inproc://bus";
  Socket server = *Socket::bus_server(context, endpoint);
  CHECK(server.send_to("nobody", to_frame("x")) == SendResult::unroutable);
  Socket client = Socket::bus_client(context, endpoint);
  SendResult result = SendResult::sent;
  for (int i = 0; i < 10 * kHighWaterMark && result == SendResult::sent; ++i) result = client.send(to_frame("x"));
  CHECK(result == SendResult::full);
}

TEST_CASE("two servers cannot bind one address") {
  init_crypto();
  GuardedInbox guarded;
  const auto second = Socket::inbox(guarded.context, guarded.inbox.last_endpoint(), make_keys());
  REQUIRE_FALSE(second.ok());
  CHECK(second.error().code == Errc::io_error);
  CHECK_FALSE(second.error().hint.empty());
}

TEST_CASE("sockets and monitors that no descriptor is left for are errors with a hint, and can be made later") {
  init_crypto();
  Context context{2};
  Loop loop;
  const CurveKeys keys = make_keys();
  Socket socket = *Socket::dialler(context, keys, keys.public_key);
  const auto watch = [&] { return SocketMonitor::watch(context, loop, socket, [](LinkEvent, int) {}); };
  const auto check = [](const auto& made) {
    REQUIRE_FALSE(made.ok());
    CHECK(made.error().code == Errc::io_error);
    CHECK(made.error().hint.find("limit of open files") != std::string::npos);
  };
  {
    const NoDescriptors none;
    check(Socket::inbox(context, "", keys));
    check(Socket::dialler(context, keys, keys.public_key));
    check(Socket::lane_server(context, keys));
    check(Socket::lane_client(context, keys, keys.public_key, "topic"));
    check(watch());
  }
  CHECK(Socket::lane_server(context, keys).ok());
  CHECK(watch().ok());
}

TEST_CASE("a monitor ends, and its socket listens elsewhere, while as much waits to be told as may") {
  init_crypto();
  Context context;
  Loop loop;
  Socket inbox = *Socket::inbox(context, "", make_keys());
  auto watch = *SocketMonitor::watch(context, loop, inbox, [](LinkEvent, int) {});
  REQUIRE(inbox.bind("tcp://127.0.0.1:*").ok());
  const std::string endpoint = inbox.last_endpoint();
  const auto port = static_cast<std::uint16_t>(std::stoi(endpoint.substr(endpoint.rfind(':') + 1)));
  // Strangers come and go until libzmq's thread waits for room for one more event.
  int came = 0;
  while (came < 10'000 && come_and_go(port)) ++came;
  CHECK(came < 10'000);
  ::alarm(30);  // a dead lock ends the test
  SUBCASE("it ends") {
    watch.reset();
  }
  SUBCASE("the socket is bound once more") {
    watch->catch_up();
    CHECK(inbox.bind("tcp://127.0.0.1:*").ok());
    watch.reset();
  }
  ::alarm(0);
}

TEST_CASE("the loop wakes for descriptors, deadlines and signals, and forgets what was removed") {
  block_signals();
  Loop loop;
  int ends[2];
  REQUIRE(::pipe(ends) == 0);
  int reads = 0;
  loop.add_fd(ends[0], POLLIN, [&](short events) {
    CHECK((events & POLLIN) != 0);
    char byte = 0;
    reads += static_cast<int>(::read(ends[0], &byte, 1));
  });
  REQUIRE(::write(ends[1], "x", 1) == 1);
  CHECK(turn_until(loop, [&] { return reads == 1; }));
  loop.remove_fd(ends[0]);
  int got = 0;
  Signals signals(loop, [&](int signal) { got = signal; });
  ::kill(::getpid(), SIGHUP);
  CHECK(turn_until(loop, [&] { return got == SIGHUP; }));
  REQUIRE(::write(ends[1], "x", 1) == 1);
  std::optional<MonotonicTime> due = read_clocks().mono + std::chrono::milliseconds(5);
  bool ticked = false;
  loop.add_timer([&] { return due; },
                 [&](Now) {
                   ticked = true;
                   due.reset();
                 });
  CHECK(turn_until(loop, [&] { return ticked; }));
  CHECK(reads == 1);
  ::close(ends[0]);
  ::close(ends[1]);
}
