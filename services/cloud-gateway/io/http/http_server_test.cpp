// The server over real sockets. What its parts refuse is told beside them, and by tests/integration/gateway_test.py;
// its WebSockets by web_socket_test.cpp.
#include "services/cloud-gateway/io/http/http_server.hpp"

#include "services/cloud-gateway/io/http/test/server_fixture.hpp"

using namespace trb;
using namespace trb::gateway;

namespace {

HttpServerSettings impatient() {
  HttpServerSettings out;
  out.times.head = std::chrono::milliseconds(50);
  out.times.idle = std::chrono::milliseconds(50);
  out.times.linger = std::chrono::milliseconds(50);
  return out;
}

HttpServerSettings with_bound(std::size_t HttpServerSettings::*which, std::size_t most) {
  HttpServerSettings out;
  out.*which = most;
  return out;
}

const std::string kGet = get("/a");

/// One client that was served, and one whose request is under way.
struct IdleAndBusy {
  explicit IdleAndBusy(ServerFixture& fixture) : idle(fixture.client()), busy(fixture.client()) {
    REQUIRE(is_served(idle));
    busy.say(get("/later"));
    REQUIRE(fixture.until([&] { return fixture.handler.kept.size() == 1; }));
  }
  TlsClient idle;
  TlsClient busy;
};

/// The handler answers all that it has kept, and each of these clients hears it.
void check_answered(ServerFixture& fixture, TlsClient& one, TlsClient& other) {
  for (const Reply& reply : fixture.handler.kept) reply({});
  CHECK(one.hear("\r\n\r\n").starts_with("HTTP/1.1 200"));
  CHECK(other.hear("\r\n\r\n").starts_with("HTTP/1.1 200"));
}

}  // namespace

TEST_CASE("server: a request is answered, and the next one on the same connection") {
  ServerFixture fixture;
  TlsClient client = fixture.client();
  client.say(kGet);
  const std::string first = client.hear("/a ");
  CHECK(first.starts_with("HTTP/1.1 200 "));
  CHECK(first.find("\r\nX-Content-Type-Options: nosniff\r\n") != std::string::npos);
  client.say("POST /b HTTP/1.1\r\nHost: localhost\r\nContent-Length: 2\r\n\r\nhi");
  CHECK(client.hear("/b hi").find("200") != std::string::npos);
}

TEST_CASE("server: HEAD is answered without a body") {
  ServerFixture fixture;
  TlsClient client = fixture.client();
  client.say("HEAD /a HTTP/1.1\r\nHost: localhost\r\nConnection: close\r\n\r\n");
  const std::string answer = client.hear("never");
  CHECK(client.ended);
  CHECK(answer.find("Content-Length: 3") != std::string::npos);
  CHECK(answer.ends_with("\r\n\r\n"));
}

TEST_CASE("server: what is no HTTP, two lengths, too long headers and a body over the bound are refused") {
  for (const auto& [text, status] : std::vector<std::pair<std::string, std::string>>{
           {"hello\r\n\r\n", "400"},
           {"GET / HTTP/1.1\r\nHost: a\r\nContent-Length: 1\r\nTransfer-Encoding: chunked\r\n\r\n", "400"},
           {"GET / HTTP/1.1\r\nHost: a\r\nX: " + std::string(9000, 'x') + "\r\n\r\n", "431"},
           {"POST / HTTP/1.1\r\nHost: a\r\nContent-Length: 1048577\r\n\r\n", "413"}}) {
    ServerFixture fixture;
    TlsClient client = fixture.client();
    client.say(text);
    CHECK(client.hear("\r\n\r\n").starts_with("HTTP/1.1 " + status));
  }
}

TEST_CASE("server: who begins no handshake is let go") {
  ServerFixture fixture(with_time(&HttpTimes::handshake, std::chrono::milliseconds(50)));
  boost::asio::ip::tcp::socket stranger(fixture.loop);
  stranger.connect({boost::asio::ip::address_v4::loopback(), fixture.server->port()});
  boost::system::error_code ended;
  char byte = 0;
  stranger.async_receive(boost::asio::buffer(&byte, 1),
                         [&](boost::system::error_code problem, std::size_t) { ended = problem; });
  CHECK(fixture.until([&] { return ended == boost::asio::error::eof; }));
  CHECK(fixture.until_alone());
}

TEST_CASE("server: who sends nothing, or headers without an end, is let go") {
  for (const char* begun : {"", "GET / HT"}) {
    ServerFixture fixture(impatient());
    TlsClient client = fixture.client();
    if (*begun != '\0') client.say(begun);
    client.hear("never");
    CHECK(client.ended);
    CHECK(fixture.until_alone());
  }
}

TEST_CASE("server: one address has so many connections and no more; those under way are served") {
  ServerFixture fixture(with_bound(&HttpServerSettings::max_of_source, 2));
  TlsClient one = fixture.client();
  TlsClient two = fixture.client();
  one.say(get("/later"));
  two.say(get("/later"));
  REQUIRE(fixture.until([&] { return fixture.handler.kept.size() == 2; }));
  TlsClient three = fixture.client();
  three.hear("never");
  CHECK(three.ended);
  check_answered(fixture, one, two);
}

TEST_CASE("server: given a full address, then its connection that was idle for longest makes room for its next one") {
  ServerFixture fixture(with_bound(&HttpServerSettings::max_of_source, 2));
  IdleAndBusy clients(fixture);
  auto& [idle, busy] = clients;
  TlsClient stop = fixture.client();
  CHECK(is_served(stop));
  CHECK(idle.is_dropped());
  CHECK(fixture.server->connections() == 2);
  fixture.handler.kept.at(0)({});
  CHECK(busy.hear("\r\n\r\n").starts_with("HTTP/1.1 200"));
}

TEST_CASE("server: the address of a proxy has more connections") {
  HttpServerSettings settings;
  settings.max_of_source = 1;
  settings.max_of_proxy = 2;
  settings.proxies = {"127.0.0.1"};
  ServerFixture fixture(settings);
  IdleAndBusy clients(fixture);
  CHECK(is_served(clients.idle));
}

TEST_CASE("server: when it stops, idle connections end and nobody else comes in") {
  ServerFixture fixture;
  TlsClient client = fixture.client();
  client.say(kGet);
  client.hear("/a ");
  fixture.server->stop();
  client.hear("never");
  CHECK(client.ended);
}

TEST_CASE("server: two requests at once get their answers in order") {
  ServerFixture fixture;
  TlsClient client = fixture.client();
  client.say(get("/a") + post("/b", "Content-Length: 2", "hi") + get("/c"));
  const std::string answers = client.hear("/c ");
  CHECK(answers.find("/a ") < answers.find("/b hi"));
  CHECK(answers.find("/b hi") < answers.find("/c "));
}

TEST_CASE("server: chunks are put together, in as many pieces as they come") {
  ServerFixture fixture;
  TlsClient client = fixture.client();
  client.say(post("/a", "Transfer-Encoding: chunked", "2\r\nhi"));
  for (const char c : std::string("\r\n3;x\r\n ho\r\n0\r\nHost: evil\r\n\r\n")) client.say(std::string(1, c));
  CHECK(client.hear("/a hi ho").starts_with("HTTP/1.1 200"));
  CHECK(is_served(client, "/b"));
}

TEST_CASE("server: chunks over 1 MiB are refused, and the client is let go") {
  ServerFixture fixture;
  TlsClient client = fixture.client();
  client.say(post("/a", "Transfer-Encoding: chunked", "100001\r\n"));
  CHECK(client.hear("never").starts_with("HTTP/1.1 413"));
  CHECK(client.ended);
}

TEST_CASE("server: who asks whether to send the body is told; what is refused is never asked for") {
  ServerFixture fixture;
  TlsClient client = fixture.client();
  client.say(post("/a", "Expect: 100-continue\r\nContent-Length: 2"));
  CHECK(client.hear("\r\n\r\n") == "HTTP/1.1 100 Continue\r\n\r\n");
  client.say("hi");
  CHECK(client.hear("/a hi").starts_with("HTTP/1.1 200"));
  client.say(post("/closed", "Expect: 100-continue\r\nContent-Length: 2"));
  const std::string refused = client.hear("never");
  CHECK(refused.starts_with("HTTP/1.1 403"));
  CHECK(refused.find("Connection: close") != std::string::npos);
}

TEST_CASE("server: a refusal is read even if the client goes on to send the body") {
  ServerFixture fixture;
  TlsClient client = fixture.client();
  client.say(post("/closed", "Content-Length: 100000", std::string(100'000, 'x')));
  CHECK(client.hear("\r\n\r\nclosed").starts_with("HTTP/1.1 403"));
}

TEST_CASE("server: a body over 1 MiB is refused without asking the handler") {
  ServerFixture fixture;
  TlsClient client = fixture.client();
  client.say(post("/a", "Content-Length: 1048577"));
  CHECK(client.hear("never").ends_with("body_too_large"));
}

TEST_CASE("server: headers or a body that do not come in time are answered 408") {
  for (const auto& [which, begun] : {std::pair(&HttpTimes::head, std::string("GET / HT")),
                                     std::pair(&HttpTimes::body, post("/a", "Content-Length: 3", "hi"))}) {
    ServerFixture fixture(with_time(which, std::chrono::milliseconds(200)));
    TlsClient client = fixture.client();
    client.say(begun);
    CHECK(client.hear("never").starts_with("HTTP/1.1 408"));
    CHECK(client.ended);
  }
}

TEST_CASE("server: given the handler never answers, then 503; its late answer is nothing") {
  ServerFixture fixture(with_time(&HttpTimes::answer, std::chrono::milliseconds(50)));
  TlsClient client = fixture.client();
  client.say(get("/later"));
  CHECK(client.hear("never").starts_with("HTTP/1.1 503"));
  fixture.handler.kept.at(0)({});
  client.shut_down();
  CHECK(fixture.until_alone());
}

TEST_CASE("server: a second answer to a request is nothing") {
  ServerFixture fixture;
  TlsClient client = fixture.client();
  client.say(get("/later"));
  REQUIRE(fixture.until([&] { return fixture.handler.kept.size() == 1; }));
  fixture.handler.kept.at(0)({200, "text/plain", {}, shared_bytes("first")});
  fixture.handler.kept.at(0)({200, "text/plain", {}, shared_bytes("second")});
  CHECK(client.hear("first").ends_with("first"));
  client.say(get("/later"));
  REQUIRE(fixture.until([&] { return fixture.handler.kept.size() == 2; }));
  fixture.handler.kept.at(0)({200, "text/plain", {}, shared_bytes("second")});
  fixture.handler.kept.at(1)({200, "text/plain", {}, shared_bytes("third")});
  CHECK(client.hear("third").find("second") == std::string::npos);
}

TEST_CASE("server: given a reply's header has a line end, then nothing of it is sent, but a 500") {
  ServerFixture fixture;
  TlsClient client = fixture.client();
  client.say(get("/two-lines"));
  const std::string answer = client.hear("bad_reply");
  CHECK(answer.starts_with("HTTP/1.1 500"));
  CHECK(answer.find("Set-Cookie") == std::string::npos);
}

TEST_CASE("server: 204 has no body, and the connection goes on") {
  ServerFixture fixture;
  TlsClient client = fixture.client();
  client.say(get("/empty") + get("/a"));
  const std::string answers = client.hear("/a ");
  CHECK(answers.starts_with("HTTP/1.1 204"));
  CHECK(answers.find("\r\n\r\nHTTP/1.1 200") != std::string::npos);
}

TEST_CASE("server: who does not read his reply is let go") {
  ServerFixture fixture(with_time(&HttpTimes::reply, std::chrono::milliseconds(300)));
  TlsClient client = fixture.client();
  client.say(get("/large"));
  REQUIRE(fixture.until([&] { return fixture.server->connections() == 1; }));
  CHECK(fixture.until_alone());
}

TEST_CASE("server: a large reply comes whole") {
  ServerFixture fixture;
  TlsClient client = fixture.client();
  client.say(get("/large", "Connection: close\r\n"));
  const std::string answer = client.hear("never");
  CHECK(answer.size() > (16U << 20U));
  CHECK(client.ended);
}

TEST_CASE("server: when it is full, the one that waits longest makes room; who is served stays") {
  ServerFixture fixture(with_bound(&HttpServerSettings::max_connections, 2));
  IdleAndBusy clients(fixture);
  auto& [idle, busy] = clients;
  TlsClient third = fixture.client();
  third.say(get("/later"));
  CHECK(idle.is_dropped());
  REQUIRE(fixture.until([&] { return fixture.handler.kept.size() == 2; }));
  TlsClient fourth = fixture.client();
  CHECK(fourth.is_dropped());
  CHECK(fixture.server->connections() == 2);
  check_answered(fixture, busy, third);
}

TEST_CASE("server: given strangers who begin no handshake hold all room, then the oldest of them makes room") {
  ServerFixture fixture(with_bound(&HttpServerSettings::max_connections, 2));
  std::vector<boost::asio::ip::tcp::socket> strangers;
  for (std::size_t i = 0; i < 2; ++i) {
    strangers.emplace_back(fixture.loop);
    strangers.back().connect({boost::asio::ip::address_v4::loopback(), fixture.server->port()});
    REQUIRE(fixture.until([&] { return fixture.server->connections() == i + 1; }));
  }
  TlsClient person = fixture.client();
  CHECK(is_served(person));
  CHECK(fixture.server->connections() == 2);
}

TEST_CASE("server: TLS 1.2 is spoken; what is older, or no TLS at all, is not") {
  ServerFixture fixture;
  TlsClient client(fixture.loop, fixture.server->port(), TLS1_2_VERSION);
  CHECK(is_served(client));
  TlsClient old(fixture.loop, fixture.server->port(), TLS1_1_VERSION);
  CHECK(old.is_dropped());
  boost::asio::ip::tcp::socket plain(fixture.loop);
  plain.connect({boost::asio::ip::address_v4::loopback(), fixture.server->port()});
  plain.send(boost::asio::buffer(kGet));
  plain.non_blocking(true);
  boost::system::error_code problem;
  char byte = 0;
  const auto has_ended = [&] {
    plain.receive(boost::asio::buffer(&byte, 1), 0, problem);
    return problem && problem != boost::asio::error::would_block;
  };
  CHECK(fixture.until(has_ended));
}

TEST_CASE("server: when it stops, a request under way is finished and is the last of its connection") {
  ServerFixture fixture;
  TlsClient client = fixture.client();
  client.say(get("/later"));
  REQUIRE(fixture.until([&] { return fixture.handler.kept.size() == 1; }));
  fixture.server->stop();
  CHECK(fixture.server->connections() == 1);
  fixture.handler.kept.at(0)({200, "text/plain", {}, shared_bytes("done")});
  const std::string answer = client.hear("never");
  CHECK(answer.find("Connection: close") != std::string::npos);
  CHECK(answer.ends_with("done"));
  client.shut_down();
  CHECK(fixture.until_alone());
}

TEST_CASE("server: given it goes while requests are under way, then their answers are nothing") {
  ServerFixture fixture;
  IdleAndBusy clients(fixture);
  auto& [idle, busy] = clients;
  fixture.server.reset();
  fixture.handler.kept.at(0)({});
  CHECK(idle.is_dropped());
  CHECK(busy.is_dropped());
}

TEST_CASE("server: what it cannot open it says, with the cure") {
  ServerFixture fixture;
  HttpServerSettings settings;
  settings.port = fixture.server->port();
  settings.certificate_file = fixture.folder.path + "/keys/gateway.crt";
  settings.key_file = fixture.folder.path + "/keys/gateway.key";
  const auto refused = [&](const HttpServerSettings& with) {
    const auto opened = HttpServer::open(fixture.loop, with, fixture.handler);
    REQUIRE_FALSE(opened);
    CHECK_FALSE(opened.error().hint.empty());
    return opened.error().code;
  };
  CHECK(refused(settings) == Errc::io_error);  // the port is taken
  settings.port = 0;
  auto wrong = settings;
  wrong.address = "localhost";
  CHECK(refused(wrong) == Errc::bad_value);
  wrong = settings;
  wrong.certificate_file += ".old";
  CHECK(refused(wrong) == Errc::bad_value);
  TemporaryFolder other;
  wrong = settings;
  wrong.key_file = provide_tls_files(other.path, {"localhost"}, UtcTime{1})->key;
  CHECK(refused(wrong) == Errc::bad_value);
}

TEST_CASE("a client that leaves before its answer is noticed by a handler that looks") {
  ServerFixture fixture;
  TlsClient client = fixture.client();
  client.say(get("/watched"));
  REQUIRE(fixture.until([&] { return fixture.handler.kept.size() == 1; }));
  CHECK(fixture.handler.left == 0);
  client.shut_down();
  CHECK(fixture.until([&] { return fixture.handler.left == 1; }));
  CHECK(fixture.until_alone());
  fixture.handler.kept[0]({});  // it is late: nothing happens
  CHECK(fixture.handler.left == 1);
}

TEST_CASE("a client that has its answer, or has sent its next request, has not left") {
  ServerFixture fixture;
  TlsClient client = fixture.client();
  client.say(get("/watched") + get("/next"));
  REQUIRE(fixture.until([&] { return fixture.handler.kept.size() == 1; }));
  HttpReply answer;
  answer.body = shared_bytes("answered");
  fixture.handler.kept[0](answer);
  CHECK(client.hear("/next ").find("answered") != std::string::npos);
  client.shut_down();
  CHECK(fixture.until_alone());
  CHECK(fixture.handler.left == 0);
}
