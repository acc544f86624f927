// The server's WebSockets, with a client that writes frames by hand (RFC 6455, 5.2).
#include "services/cloud-gateway/io/http/test/server_fixture.hpp"

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

/// A server with one open WebSocket.
struct SocketFixture : ServerFixture {
  explicit SocketFixture(const HttpServerSettings& settings = {}) : ServerFixture(settings) {
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
  SocketFixture fixture;
  CHECK(fixture.consent.starts_with("HTTP/1.1 101"));
  CHECK(fixture.consent.find("Sec-WebSocket-Accept: s3pPLMBiTxaQ9kYGzzhZRbK+xOo=") != std::string::npos);
  CHECK(fixture.consent.find("X-Content-Type-Options: nosniff") != std::string::npos);
  CHECK(fixture.consent.find("Beast") == std::string::npos);
}

TEST_CASE("websocket: each text is answered by one text of all parts, and sent is told") {
  SocketFixture fixture;
  for (int i = 1; i <= 3; ++i) {
    fixture.user.say_frame(kText, "hello");
    const WebSocketFrame frame = fixture.user.hear_frame();
    CHECK(frame.opcode == 1);
    CHECK(frame.payload == "you said: hello");
    CHECK(fixture.until([&] { return fixture.socket().sent == i; }));
  }
  fixture.user.say_frame(kPing, "are you there");
  CHECK(fixture.user.hear_frame().payload == "are you there");
}

TEST_CASE("websocket: a message may have 4096 bytes, also in fragments, of which the last is empty") {
  SocketFixture fixture;
  fixture.user.say_frame(kText, std::string(kMaxWebSocketMessage, 'a'));
  CHECK(fixture.user.hear_frame().payload.size() == kMaxWebSocketMessage + 10);
  fixture.user.say_frame(kFirstText, std::string(kMaxWebSocketMessage, 'b'));
  fixture.user.say_frame(kContinuation, "");
  CHECK(fixture.user.hear_frame().payload.size() == kMaxWebSocketMessage + 10);
}

TEST_CASE("websocket: what is too long, binary, not UTF-8 or no frame closes it, with the code that says why") {
  struct Wrong {
    unsigned first;
    std::string payload;
    unsigned code;
  };
  for (const Wrong& wrong : {Wrong{kText, std::string(kMaxWebSocketMessage + 1, 'a'), 1009},
                             Wrong{kBinary, "hello", 1003}, Wrong{kText, "\xff", 1007}, Wrong{0xf3, "", 1002}}) {
    SocketFixture fixture;
    fixture.user.say_frame(wrong.first, wrong.payload);
    CHECK(fixture.user.hear_frame().code() == wrong.code);
    fixture.user.say_frame(kClose, "");
    fixture.user.shut_down();
    CHECK(fixture.until_closed());
    CHECK(fixture.socket().texts.empty());
  }
}

TEST_CASE("websocket: the client closes it, or is gone: that is told once") {
  for (const bool politely : {true, false}) {
    SocketFixture fixture;
    if (politely) {
      fixture.user.say_frame(kClose, "\x03\xe8");
      CHECK(fixture.user.hear_frame().code() == 1000);
    }
    fixture.user.shut_down();
    CHECK(fixture.until_closed());
  }
}

TEST_CASE("websocket: the gateway closes it, with a reason of 123 bytes at most") {
  SocketFixture fixture;
  fixture.socket().out->close(4401, std::string(122, 'a') + "\xc3\xa9");
  fixture.socket().out->close(4402, "twice");
  fixture.socket().out->send({shared_bytes("too late")});
  const WebSocketFrame frame = fixture.user.hear_frame();
  CHECK(frame.code() == 4401);
  CHECK(frame.payload.substr(2) == std::string(122, 'a'));
  fixture.user.say_frame(kText, "not heard any more");
  fixture.user.say_frame(kClose, "");
  fixture.user.shut_down();
  CHECK(fixture.until_closed());
  CHECK(fixture.socket().texts.empty());
}

TEST_CASE("websocket: what is being sent comes before the close") {
  SocketFixture fixture;
  fixture.socket().out->send({shared_bytes(Bytes(30'000, 'a')), shared_bytes(Bytes(30'000, 'b'))});
  fixture.socket().out->close(1008, "");
  CHECK(fixture.user.hear_frame().payload.size() == 60'000);
  CHECK(fixture.user.hear_frame().code() == 1008);
}

TEST_CASE("websocket: given the client never confirms the close, then it ends in time") {
  SocketFixture fixture(with_time(&HttpTimes::reply, std::chrono::milliseconds(100)));
  fixture.socket().out->close(1008, "");
  CHECK(fixture.until_closed());
}

TEST_CASE("websocket: who does not take what is sent is let go") {
  SocketFixture fixture(with_time(&HttpTimes::reply, std::chrono::milliseconds(300)));
  fixture.socket().out->send({shared_bytes(Bytes(16U << 20U, 'x'))});
  CHECK(fixture.until_closed());
  CHECK(fixture.socket().sent == 0);
}

TEST_CASE("websocket: who answers a ping stays, and is pinged again") {
  // An answer must come within half of that, on a slow machine too.
  SocketFixture fixture(with_time(&HttpTimes::ping, std::chrono::seconds(8)));
  const WebSocketFrame ping = fixture.user.hear_frame();
  CHECK(ping.opcode == 9);
  fixture.user.say_frame(kPong, ping.payload);
  CHECK(fixture.user.hear_frame().opcode == 9);
  CHECK(fixture.socket().closed == 0);
}

TEST_CASE("websocket: who does not answer a ping is let go") {
  SocketFixture fixture(with_time(&HttpTimes::ping, std::chrono::seconds(2)));
  CHECK(fixture.user.hear_frame().opcode == 9);
  CHECK(fixture.until_closed());
}

TEST_CASE("websocket: when the server stops, it ends with 1001") {
  SocketFixture fixture;
  fixture.server->stop();
  CHECK(fixture.user.hear_frame().code() == 1001);
  fixture.user.say_frame(kClose, "\x03\xe9");
  fixture.user.shut_down();
  CHECK(fixture.until_closed());
}

TEST_CASE("websocket: when the server goes, that is told at once, and once") {
  SocketFixture fixture;
  const auto out = fixture.socket().out;
  fixture.socket().out->send({shared_bytes(Bytes(16U << 20U, 'x'))});
  fixture.server.reset();
  CHECK(fixture.socket().closed == 1);
  out->send({shared_bytes("nobody hears it")});
  out->close(1000, "");
  fixture.user.hear("never");
  CHECK(fixture.user.ended);
  CHECK(fixture.socket().closed == 1);
  CHECK(fixture.socket().sent == 0);
}

TEST_CASE("websocket: what the handler refuses gets its reply, and the connection goes on as HTTP") {
  ServerFixture fixture;
  TlsClient client = fixture.client();
  client.say(get("/other", kUpgrade));
  CHECK(client.hear("no_websocket").starts_with("HTTP/1.1 403"));
  CHECK(is_served(client));
}

TEST_CASE("websocket: another version, or frames before the consent, are refused") {
  ServerFixture fixture;
  TlsClient old = fixture.client();
  old.say(get("/live", "Connection: Upgrade\r\nUpgrade: websocket\r\nSec-WebSocket-Version: 8\r\n"));
  const std::string answer = old.hear("never");
  CHECK(answer.starts_with("HTTP/1.1 426"));
  CHECK(answer.find("Sec-WebSocket-Version: 13") != std::string::npos);
  TlsClient hasty = fixture.client();
  hasty.say(get("/live", kUpgrade) + "frame");
  CHECK(hasty.hear("never").starts_with("HTTP/1.1 400"));
  CHECK(fixture.handler.sockets.empty());
}
