// The node's bus over real sockets: Hello first, and connections that are gone.
#include "services/router/io/bus_sockets.hpp"

#include <string>
#include <vector>

#include "proto/body.hpp"
#include "services/router/test/test_shell.hpp"

using namespace trb;
using namespace trb::router;

namespace {

Bytes hello(const std::string& service) {
  return encode(ServiceHello{service, {}, 11, 12, "1"});
}

}  // namespace

TEST_CASE("a client that has not said Hello is asked for it, and known afterwards") {
  ShellParts parts;
  REQUIRE(parts.bus.open().ok());
  BusClient probe(parts, "probe");
  probe.send("service_list", "");
  std::string answer;
  REQUIRE(parts.turn_until([&] { return !(answer = probe.receive()).empty(); }));
  CHECK(answer == "hello_wanted");
  CHECK(parts.counted("sent.service_list") == 0);

  probe.send("service_hello", hello("probe"));
  REQUIRE(parts.turn_until([&] { return !parts.all<BusSend>().empty(); }));
  CHECK(parts.all<BusSend>().front().message.subtype == "service_welcome");
  CHECK(parts.core.bus().knows(1));
}

TEST_CASE("a burst of a client that is not known is answered by one request for its hello, another client by its own") {
  ShellParts parts;
  REQUIRE(parts.bus.open().ok());
  BusClient first(parts, "probe");
  for (int i = 0; i < 100; ++i) first.send("service_list", "");
  BusClient second(parts, "probe");
  second.send("service_list", "");
  std::string answer;
  REQUIRE(parts.turn_until([&] { return !(answer = second.receive()).empty(); }));
  CHECK(answer == "hello_wanted");
  // Behind all of the burst
  first.send("service_hello", hello("probe"));
  REQUIRE(parts.turn_until([&] { return parts.core.bus().knows(1); }));
  int asked = 0;
  CHECK(parts.bus.send(1, to_frame("the last")) == SendResult::sent);
  REQUIRE(parts.turn_until([&] {
    answer = first.receive();
    asked += answer == "hello_wanted" ? 1 : 0;
    return answer == "malformed";
  }));
  CHECK(asked < 50);
}

TEST_CASE("a frame to a known connection arrives; to one that has gone it is unroutable, and the core forgets it") {
  ShellParts parts;
  REQUIRE(parts.bus.open().ok());
  {
    BusClient adapter(parts, "mode-adapter");
    adapter.send("service_hello", hello("mode-adapter"));
    REQUIRE(parts.turn_until([&] { return parts.core.bus().knows(1); }));
    CHECK(parts.bus.send(1, to_frame("a frame")) == SendResult::sent);
    Frame frame;
    REQUIRE(parts.turn_until([&] { return adapter.socket.receive(frame); }));
    CHECK(view_of(frame) == "a frame");
  }
  REQUIRE(parts.turn_until([&] { return parts.bus.send(1, to_frame("late")) == SendResult::unroutable; }));
  CHECK_FALSE(parts.core.bus().knows(1));
  CHECK(parts.bus.send(2, to_frame("nobody")) == SendResult::unroutable);
}

TEST_CASE("bytes that are no frame are counted, and cost the connection nothing") {
  ShellParts parts;
  REQUIRE(parts.bus.open().ok());
  BusClient adapter(parts, "mode-adapter");
  adapter.send_frame("rubbish");
  REQUIRE(parts.turn_until([&] { return parts.counted("refused.version_mismatch") == 1; }));
  adapter.send("service_hello", hello("mode-adapter"));
  CHECK(parts.turn_until([&] { return parts.core.bus().knows(1); }));
}

TEST_CASE("a bus in the folder admits no key; one over TCP those of its services") {
  ShellParts parts;
  CHECK_FALSE(parts.bus.admit(Bytes(32, 'k')));
  TcpBusGuard guard(parts.shell, {{Bytes(32, 'k'), "scheduler"}});
  CHECK(guard.admit(Bytes(32, 'k')));
  CHECK_FALSE(guard.admit(Bytes(32, 'x')));
  CHECK(parts.counted("refused.bus_key") == 1);
  CHECK(guard.name_of(to_frame("a frame that came by no connection")).empty());
}

TEST_CASE("a peer that sends faster than a service reads gets no more room; another peer's and the node's own arrive") {
  ShellParts parts;
  REQUIRE(parts.bus.open().ok());
  BusClient adapter(parts, "mode-adapter");
  adapter.send("service_hello", hello("mode-adapter"));
  REQUIRE(parts.turn_until([&] { return parts.core.bus().knows(1); }));
  constexpr std::size_t kMany = 100'000;  // the kernel and the client have queues, too
  std::size_t sent = 0;
  while (sent < kMany && parts.bus.send_of("bee", 1, to_frame("a frame of bee")) == SendResult::sent) ++sent;
  CHECK(sent >= WaitingFrames::kMost / 2);
  REQUIRE(sent < kMany);
  CHECK(parts.counted("dropped.peer_share") == 1);
  CHECK(parts.bus.send_of("cat", 1, to_frame("a frame of cat")) == SendResult::sent);
  CHECK(parts.bus.send_of("ant", 1, to_frame("a frame of its own node")) == SendResult::sent);
  CHECK(parts.bus.send(1, to_frame("a frame of the router")) == SendResult::sent);
  std::size_t more = 0;  // the kernel may have taken some meanwhile
  while (more < kMany && parts.bus.send_of("bee", 1, to_frame("a frame of bee")) == SendResult::sent) ++more;
  REQUIRE(more < kMany);

  std::vector<std::string> expected(sent, "a frame of bee");
  expected.insert(expected.end(), {"a frame of cat", "a frame of its own node", "a frame of the router"});
  expected.insert(expected.end(), more, "a frame of bee");
  Frame frame;
  for (const std::string& text : expected) {
    REQUIRE(parts.turn_until([&] { return adapter.socket.receive(frame); }));
    CHECK(view_of(frame) == text);
  }
  CHECK(parts.turn_until([&] { return parts.bus.send_of("bee", 1, to_frame("more")) == SendResult::sent; }));
}
