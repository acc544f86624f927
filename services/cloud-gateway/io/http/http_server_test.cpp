// The server over real sockets. What its parts refuse is told beside them, and by tests/integration/gateway_test.py.
#include "services/cloud-gateway/io/http/http_server.hpp"

#include <doctest/doctest.h>
#include <openssl/ssl.h>

#include <boost/asio/io_context.hpp>
#include <boost/asio/ip/tcp.hpp>
#include <memory>

#include "common/base/test/temporary_folder.hpp"
#include "services/cloud-gateway/io/http/tls_files.hpp"

using namespace trb;
using namespace trb::gateway;

namespace {

/// Answers each request with its own path; refuses bodies over 100 bytes; keeps its WebSockets' texts.
class EchoHandler final : public HttpHandler {
 public:
  std::optional<HttpReply> before_body(const HttpRequest&, std::uint64_t body_size) override {
    if (body_size <= 100) return std::nullopt;
    return refusal(413, "too_large", "", "");
  }
  void on_request(HttpRequest request, Reply reply) override {
    HttpReply out;
    out.body = std::make_shared<const Bytes>(request.target + " " + request.body);
    reply(std::move(out));
  }
  std::variant<std::shared_ptr<WebSocketIn>, HttpReply> on_upgrade(const HttpRequest&) override {
    return refusal(403, "no_websocket", "", "");
  }
  HttpReply refusal(int status, const std::string& code, const std::string&, const std::string&) override {
    HttpReply out;
    out.status = status;
    out.body = std::make_shared<const Bytes>(code);
    return out;
  }
};

/// A client that never waits: it is pumped together with the server's loop.
class TlsClient {
 public:
  TlsClient(boost::asio::io_context& loop, std::uint16_t port) : loop_(loop), socket_(loop) {
    socket_.connect({boost::asio::ip::address_v4::loopback(), port});
    socket_.non_blocking(true);
    tls_ = SSL_new(context());
    SSL_set_fd(tls_, socket_.native_handle());
    SSL_set_connect_state(tls_);
  }
  TlsClient(const TlsClient&) = delete;
  TlsClient& operator=(const TlsClient&) = delete;
  ~TlsClient() { SSL_free(tls_); }

  void say(const std::string& text) {
    REQUIRE(until([&] { return SSL_write(tls_, text.data(), static_cast<int>(text.size())) > 0; }));
  }
  /// All that comes until this text is in it, or the connection ends.
  std::string hear(const std::string& end) {
    std::string out;
    until([&] {
      char buffer[4096];
      const int got = SSL_read(tls_, buffer, sizeof buffer);
      if (got > 0) out.append(buffer, static_cast<std::size_t>(got));
      const int error = got > 0 ? SSL_ERROR_NONE : SSL_get_error(tls_, got);
      ended = error != SSL_ERROR_NONE && error != SSL_ERROR_WANT_READ;
      return ended || out.find(end) != std::string::npos;
    });
    return out;
  }
  bool ended = false;

 private:
  static SSL_CTX* context() {
    static const std::unique_ptr<SSL_CTX, void (*)(SSL_CTX*)> made(SSL_CTX_new(TLS_client_method()), SSL_CTX_free);
    return made.get();
  }
  template <class Condition>
  bool until(Condition condition) {
    const auto end = std::chrono::steady_clock::now() + std::chrono::seconds(10);
    while (!condition()) {
      if (end < std::chrono::steady_clock::now()) return false;
      loop_.run_for(std::chrono::milliseconds(1));
      loop_.restart();
    }
    return true;
  }

  boost::asio::io_context& loop_;
  boost::asio::ip::tcp::socket socket_;
  SSL* tls_ = nullptr;
};

struct ServerBench {
  explicit ServerBench(HttpServerSettings settings = {}) {
    const auto files = provide_tls_files(folder.path, {"localhost"}, UtcTime{1'800'000'000'000'000'000});
    REQUIRE(files);
    settings.port = 0;
    settings.certificate_file = files->certificate;
    settings.key_file = files->key;
    auto opened = HttpServer::open(loop, settings, handler);
    REQUIRE(opened);
    server = std::move(*opened);
  }
  TlsClient client() { return TlsClient(loop, server->port()); }
  /// The server has no connection any more, 10 s from now at the latest.
  bool until_alone() {
    for (int turns = 0; turns < 10'000 && server->connections() > 0; ++turns) {
      loop.run_for(std::chrono::milliseconds(1));
      loop.restart();
    }
    return server->connections() == 0;
  }

  TemporaryFolder folder;
  boost::asio::io_context loop;
  EchoHandler handler;
  std::unique_ptr<HttpServer> server;
};

HttpServerSettings impatient() {
  HttpServerSettings out;
  out.times.head = std::chrono::milliseconds(50);
  out.times.idle = std::chrono::milliseconds(50);
  out.times.linger = std::chrono::milliseconds(50);
  return out;
}

const std::string kGet = "GET /a HTTP/1.1\r\nHost: localhost\r\n\r\n";

}  // namespace

TEST_CASE("server: a request is answered, and the next one on the same connection") {
  ServerBench bench;
  TlsClient client = bench.client();
  client.say(kGet);
  const std::string first = client.hear("/a ");
  CHECK(first.starts_with("HTTP/1.1 200 "));
  CHECK(first.find("\r\nX-Content-Type-Options: nosniff\r\n") != std::string::npos);
  client.say("POST /b HTTP/1.1\r\nHost: localhost\r\nContent-Length: 2\r\n\r\nhi");
  CHECK(client.hear("/b hi").find("200") != std::string::npos);
}

TEST_CASE("server: HEAD is answered without a body") {
  ServerBench bench;
  TlsClient client = bench.client();
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
           {"POST / HTTP/1.1\r\nHost: a\r\nContent-Length: 101\r\n\r\n", "413"}}) {
    ServerBench bench;
    TlsClient client = bench.client();
    client.say(text);
    CHECK(client.hear("\r\n\r\n").starts_with("HTTP/1.1 " + status));
  }
}

TEST_CASE("server: who sends nothing, or headers without an end, is let go") {
  for (const char* begun : {"", "GET / HT"}) {
    ServerBench bench(impatient());
    TlsClient client = bench.client();
    if (*begun != '\0') client.say(begun);
    client.hear("never");
    CHECK(client.ended);
    CHECK(bench.until_alone());
  }
}

TEST_CASE("server: one address has so many connections and no more; the others are served") {
  HttpServerSettings settings;
  settings.max_of_source = 2;
  ServerBench bench(settings);
  TlsClient one = bench.client();
  TlsClient two = bench.client();
  one.say(kGet);
  two.say(kGet);
  CHECK(two.hear("/a ").starts_with("HTTP/1.1 200"));
  TlsClient three = bench.client();
  three.hear("never");
  CHECK(three.ended);
  CHECK(one.hear("/a ").starts_with("HTTP/1.1 200"));
}

TEST_CASE("server: when it stops, idle connections end and nobody else comes in") {
  ServerBench bench;
  TlsClient client = bench.client();
  client.say(kGet);
  client.hear("/a ");
  bench.server->stop();
  client.hear("never");
  CHECK(client.ended);
}
