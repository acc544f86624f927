// The server's WebSockets, with a client that writes frames by hand (RFC 6455, 5.2).
#include "services/cloud-gateway/io/http/test/server_bench.hpp"

using namespace trb;
using namespace trb::gateway;

namespace {

constexpr unsigned kContinuation = 0x80;
constexpr unsigned kText = 0x81;
constexpr unsigned kFirstText = 0x01;  ///< more fragments follow
constexpr unsigned kBinary = 0x82;
constexpr unsigned kClose = 0x88;
constexpr unsigned kPing = 0x89;
constexpr unsigned kPong = 0x8a;
const std::string kUpgrade =
    "Connection: Upgrade\r\nUpgrade: websocket\r\nSec-WebSocket-Version: 13\r\n"
    "Sec-WebSocket-Key: dGhlIHNhbXBsZSBub25jZQ==\r\n";

/// A bench with one open WebSocket.
struct SocketBench : ServerBench {
  explicit SocketBench(const HttpServerSettings& settings = {}) : ServerBench(settings) {
    user.say(get("/live", kUpgrade));
    consent = user.hear("\r\n\r\n");
    REQUIRE(until([&] { return !handler.sockets.empty() && socket().out != nullptr; }));
  }
  EchoSocket& socket() { return *handler.sockets.at(0); }
  /// It ends, and is told once.
  bool until_closed() {
    const bool alone = until_alone();
    return alone && socket().closed == 1;
  }

  TlsClient user = client();
  std::string consent;
};

}  // namespace

TEST_CASE("websocket: it opens with the key's answer, and without the name of the library") {
  SocketBench bench;
  CHECK(bench.consent.starts_with("HTTP/1.1 101"));
  CHECK(bench.consent.find("Sec-WebSocket-Accept: s3pPLMBiTxaQ9kYGzzhZRbK+xOo=") != std::string::npos);
  CHECK(bench.consent.find("X-Content-Type-Options: nosniff") != std::string::npos);
  CHECK(bench.consent.find("Beast") == std::string::npos);
}

TEST_CASE("websocket: each text is answered by one text of all parts, and sent is told") {
  SocketBench bench;
  for (int i = 1; i <= 3; ++i) {
    bench.user.say_frame(kText, "hello");
    const WebSocketFrame frame = bench.user.hear_frame();
    CHECK(frame.opcode == 1);
    CHECK(frame.payload == "you said: hello");
    CHECK(bench.until([&] { return bench.socket().sent == i; }));
  }
  bench.user.say_frame(kPing, "are you there");
  CHECK(bench.user.hear_frame().payload == "are you there");
}

TEST_CASE("websocket: a message may have 4096 bytes, also in fragments, of which the last is empty") {
  SocketBench bench;
  bench.user.say_frame(kText, std::string(kMaxWebSocketMessage, 'a'));
  CHECK(bench.user.hear_frame().payload.size() == kMaxWebSocketMessage + 10);
  bench.user.say_frame(kFirstText, std::string(kMaxWebSocketMessage, 'b'));
  bench.user.say_frame(kContinuation, "");
  CHECK(bench.user.hear_frame().payload.size() == kMaxWebSocketMessage + 10);
}

TEST_CASE("websocket: what is too long, binary, not UTF-8 or no frame closes it, with the code that says why") {
  struct Wrong {
    unsigned first;
    std::string payload;
    unsigned code;
  };
  for (const Wrong& wrong : {Wrong{kText, std::string(kMaxWebSocketMessage + 1, 'a'), 1009},
                             Wrong{kBinary, "hello", 1003}, Wrong{kText, "\xff", 1007}, Wrong{0xf3, "", 1002}}) {
    SocketBench bench;
    bench.user.say_frame(wrong.first, wrong.payload);
    CHECK(bench.user.hear_frame().code() == wrong.code);
    bench.user.say_frame(kClose, "");
    bench.user.shut_down();
    CHECK(bench.until_closed());
    CHECK(bench.socket().texts.empty());
  }
}

TEST_CASE("websocket: the client closes it, or is gone: that is told once") {
  for (const bool politely : {true, false}) {
    SocketBench bench;
    if (politely) {
      bench.user.say_frame(kClose, "\x03\xe8");
      CHECK(bench.user.hear_frame().code() == 1000);
    }
    bench.user.shut_down();
    CHECK(bench.until_closed());
  }
}

TEST_CASE("websocket: the gateway closes it, with a reason of 123 bytes at most") {
  SocketBench bench;
  bench.socket().out->close(4401, std::string(122, 'a') + "\xc3\xa9");
  bench.socket().out->close(4402, "twice");
  bench.socket().out->send({shared_bytes("too late")});
  const WebSocketFrame frame = bench.user.hear_frame();
  CHECK(frame.code() == 4401);
  CHECK(frame.payload.substr(2) == std::string(122, 'a'));
  bench.user.say_frame(kText, "not heard any more");
  bench.user.say_frame(kClose, "");
  bench.user.shut_down();
  CHECK(bench.until_closed());
  CHECK(bench.socket().texts.empty());
}

TEST_CASE("websocket: what is being sent comes before the close") {
  SocketBench bench;
  bench.socket().out->send({shared_bytes(Bytes(30'000, 'a')), shared_bytes(Bytes(30'000, 'b'))});
  bench.socket().out->close(1008, "");
  CHECK(bench.user.hear_frame().payload.size() == 60'000);
  CHECK(bench.user.hear_frame().code() == 1008);
}

TEST_CASE("websocket: given the client never confirms the close, then it ends in time") {
  SocketBench bench(with_time(&HttpTimes::reply, std::chrono::milliseconds(100)));
  bench.socket().out->close(1008, "");
  CHECK(bench.until_closed());
}

TEST_CASE("websocket: who does not take what is sent is let go") {
  SocketBench bench(with_time(&HttpTimes::reply, std::chrono::milliseconds(300)));
  bench.socket().out->send({shared_bytes(Bytes(16U << 20U, 'x'))});
  CHECK(bench.until_closed());
  CHECK(bench.socket().sent == 0);
}

TEST_CASE("websocket: who does not answer a ping is let go; who answers stays") {
  SocketBench bench(with_time(&HttpTimes::ping, std::chrono::milliseconds(1000)));
  for (int i = 0; i < 2; ++i) {
    const WebSocketFrame ping = bench.user.hear_frame();
    CHECK(ping.opcode == 9);
    bench.user.say_frame(kPong, ping.payload);
  }
  CHECK(bench.socket().closed == 0);
  CHECK(bench.until_closed());
}

TEST_CASE("websocket: when the server stops, it ends with 1001") {
  SocketBench bench;
  bench.server->stop();
  CHECK(bench.user.hear_frame().code() == 1001);
  bench.user.say_frame(kClose, "\x03\xe9");
  bench.user.shut_down();
  CHECK(bench.until_closed());
}

TEST_CASE("websocket: when the server goes, that is told at once, and once") {
  SocketBench bench;
  const auto out = bench.socket().out;
  bench.socket().out->send({shared_bytes(Bytes(16U << 20U, 'x'))});
  bench.server.reset();
  CHECK(bench.socket().closed == 1);
  out->send({shared_bytes("nobody hears it")});
  out->close(1000, "");
  bench.user.hear("never");
  CHECK(bench.user.ended);
  CHECK(bench.socket().closed == 1);
  CHECK(bench.socket().sent == 0);
}

TEST_CASE("websocket: what the handler refuses gets its reply, and the connection goes on as HTTP") {
  ServerBench bench;
  TlsClient client = bench.client();
  client.say(get("/other", kUpgrade));
  CHECK(client.hear("no_websocket").starts_with("HTTP/1.1 403"));
  client.say(get("/a"));
  CHECK(client.hear("/a ").starts_with("HTTP/1.1 200"));
}

TEST_CASE("websocket: another version, or frames before the consent, are refused") {
  ServerBench bench;
  TlsClient old = bench.client();
  old.say(get("/live", "Connection: Upgrade\r\nUpgrade: websocket\r\nSec-WebSocket-Version: 8\r\n"));
  const std::string answer = old.hear("never");
  CHECK(answer.starts_with("HTTP/1.1 426"));
  CHECK(answer.find("Sec-WebSocket-Version: 13") != std::string::npos);
  TlsClient hasty = bench.client();
  hasty.say(get("/live", kUpgrade) + "frame");
  CHECK(hasty.hear("never").starts_with("HTTP/1.1 400"));
  CHECK(bench.handler.sockets.empty());
}
