// The lossy lane's sockets: a subscriber receives only what it was allowed, and one that does not read delays no other.
#include <doctest/doctest.h>

#include <thread>

#include "common/security/keys.hpp"
#include "common/transport/loop.hpp"
#include "common/transport/socket.hpp"
#include "common/transport/zap.hpp"

using namespace trb;

namespace {

CurveKeys make_keys() {
  const LinkKey key = make_link_key();
  return {key.public_key, key.secret_key};
}

struct Lane {
  Context context{2};
  Loop loop;
  CurveKeys keys = make_keys();
  ZapServer zap{context, loop, [](BytesView domain, BytesView) { return domain == kLaneDomain; }};
  Socket server = *Socket::lane_server(context, keys);
  std::string endpoint;

  Lane() {
    REQUIRE(server.bind("tcp://127.0.0.1:*").ok());
    endpoint = server.last_endpoint();
    // The tests read the sockets directly: the loop looks again every few milliseconds.
    loop.add_timer([] { return std::optional(read_clocks().mono + std::chrono::milliseconds(2)); }, [](Now) {});
  }

  template <class F>
  bool soon(const F& condition) {
    const MonotonicTime end = read_clocks().mono + std::chrono::seconds(60);
    while (read_clocks().mono < end) {
      if (condition()) return true;
      loop.turn();
    }
    return false;
  }
  Socket listener(BytesView topic) {
    Socket client = *Socket::lane_client(context, make_keys(), keys.public_key, topic);
    REQUIRE(client.dial(endpoint).ok());
    return client;
  }
  /// The next subscription frame.
  Bytes asked() {
    Frame frame;
    if (!soon([&] { return server.receive(frame); })) return "nothing";
    CHECK(subscriber_fd(frame) >= 0);
    CHECK(user_id(frame).size() == 64);
    return Bytes(view_of(frame));
  }
  SendResult say(BytesView topic, BytesView text) {
    if (const SendResult first = server.send(to_frame(topic), true); first != SendResult::sent) return first;
    return server.send(to_frame(text));
  }
};

/// The second frame of what was received.
Bytes heard(Lane& lane, Socket& client) {
  Frame frame;
  if (!lane.soon([&] { return client.receive(frame); })) return "nothing";
  while (frame.more()) REQUIRE(client.receive(frame));
  return Bytes(view_of(frame));
}

}  // namespace

TEST_CASE("a subscription is asked for, and hears only what is let") {
  init_crypto();
  Lane lane;
  Socket ant = lane.listener(Bytes("ant\0", 4));
  REQUIRE(lane.asked() == Bytes("\1ant\0", 5));
  lane.server.let_listen(Bytes("ant\0", 4));
  Socket all = lane.listener("");
  REQUIRE(lane.asked() == "\1");  // not allowed
  CHECK(lane.say(Bytes("bee\0", 4), "for bee") == SendResult::sent);
  CHECK(lane.say(Bytes("ant\0", 4), "for ant") == SendResult::sent);
  CHECK(heard(lane, ant) == "for ant");
  // What it hears first is what was said once it may.
  lane.server.let_listen("");
  CHECK(lane.say(Bytes("bee\0", 4), "for all") == SendResult::sent);
  CHECK(heard(lane, all) == "for all");
}

TEST_CASE("a listener that does not read is full by itself, and the others hear on") {
  init_crypto();
  Lane lane;
  Socket stuck = lane.listener("s");
  REQUIRE(lane.asked() == "\1s");
  lane.server.let_listen("s");
  Socket reader = lane.listener("r");
  REQUIRE(lane.asked() == "\1r");
  lane.server.let_listen("r");
  const Bytes text(4096, 'x');
  int sent = 0;
  REQUIRE(lane.soon([&] {
    for (int i = 0; i < 100; ++i, ++sent) {
      if (lane.say("s", text) == SendResult::full) return true;
    }
    return false;
  }));
  CHECK(sent >= kLaneHighWaterMark);
  for (int i = 0; i < 1000; ++i) {
    REQUIRE(lane.say("r", std::to_string(i)) == SendResult::sent);
    REQUIRE(heard(lane, reader) == std::to_string(i));
  }
}
