// A server, its handler and clients that say exactly what a test tells them, all on one loop and one thread.
#pragma once

#include <doctest/doctest.h>
#include <openssl/err.h>
#include <openssl/ssl.h>

#include <algorithm>
#include <boost/asio/io_context.hpp>
#include <boost/asio/ip/tcp.hpp>
#include <csignal>
#include <functional>
#include <memory>

#include "common/base/test/temporary_folder.hpp"
#include "services/cloud-gateway/io/http/http_server.hpp"
#include "services/cloud-gateway/io/http/tls_files.hpp"

namespace trb::gateway {

inline std::shared_ptr<const Bytes> shared_bytes(Bytes bytes) {
  return std::make_shared<const Bytes>(std::move(bytes));
}

/// Runs the loop until the condition holds; false: it did not within a minute.
template <class Condition>
bool pump_until(boost::asio::io_context& loop, Condition condition) {
  const auto end = std::chrono::steady_clock::now() + std::chrono::seconds(60);
  while (!condition()) {
    if (end < std::chrono::steady_clock::now()) return false;
    loop.run_for(std::chrono::milliseconds(1));
    loop.restart();
  }
  return true;
}

/// Says each text back, in two parts; keeps what it was told.
struct EchoSocket final : WebSocketIn {
  void on_open(std::shared_ptr<WebSocketOut> open) override { out = std::move(open); }
  void on_message(BytesView text) override {
    texts.emplace_back(text);
    out->send({shared_bytes("you said: "), shared_bytes(Bytes(text))});
  }
  void on_sent() override { ++sent; }
  void on_closed() override {
    ++closed;
    out = nullptr;
  }
  std::shared_ptr<WebSocketOut> out;
  std::vector<std::string> texts;
  int sent = 0;
  int closed = 0;
};

/// Answers each request with its own path and body; refuses bodies for /closed before they are read.
struct EchoHandler final : HttpHandler {
  std::optional<HttpReply> before_body(const HttpRequest& request) override {
    if (request.target != "/closed") return std::nullopt;
    return refusal(403, "closed", "", "");
  }
  void on_request(HttpRequest request, Reply reply) override {
    HttpReply out;
    out.body = shared_bytes(request.target + " " + request.body);
    if (request.target == "/empty") out = {204, "", {}, nullptr};
    if (request.target == "/two-lines") out.headers = {{"X-Name", "ann\r\nSet-Cookie: a=b"}};
    if (request.target == "/large") out.body = shared_bytes(Bytes(16U << 20U, 'x'));
    if (request.target == "/watched") request.client->on_left = [this] { ++left; };
    if (request.target == "/later" || request.target == "/watched") return kept.push_back(std::move(reply));
    reply(std::move(out));
  }
  std::variant<std::shared_ptr<WebSocketIn>, HttpReply> on_upgrade(const HttpRequest& request) override {
    if (request.target != "/live") return refusal(403, "no_websocket", "", "");
    return sockets.emplace_back(std::make_shared<EchoSocket>());
  }
  HttpReply refusal(int status, const std::string& code, const std::string&, const std::string&) override {
    return {status, "text/plain", {}, shared_bytes(code)};
  }
  std::vector<Reply> kept;
  int left = 0;
  std::vector<std::shared_ptr<EchoSocket>> sockets;
};

struct WebSocketFrame {
  unsigned opcode = 0;
  Bytes payload;
  /// Of a close frame (RFC 6455, 5.5.1); 0: none.
  [[nodiscard]] unsigned code() const {
    if (opcode != 8 || payload.size() < 2) return 0;
    return static_cast<unsigned char>(payload[0]) * 256U + static_cast<unsigned char>(payload[1]);
  }
};

/// A client that never waits: it is pumped together with the server's loop.
class TlsClient {
 public:
  TlsClient(boost::asio::io_context& loop, std::uint16_t port, int newest_version = 0) : loop_(loop), socket_(loop) {
    std::signal(SIGPIPE, SIG_IGN);  // OpenSSL writes to a closed socket as anybody does
    socket_.connect({boost::asio::ip::address_v4::loopback(), port});
    socket_.non_blocking(true);
    tls_ = SSL_new(context());
    SSL_set_max_proto_version(tls_, newest_version);
    SSL_set_fd(tls_, socket_.native_handle());
    SSL_set_connect_state(tls_);
  }
  TlsClient(const TlsClient&) = delete;
  TlsClient& operator=(const TlsClient&) = delete;
  ~TlsClient() { SSL_free(tls_); }

  void say(const std::string& text) {
    REQUIRE(pump_until(loop_, [&] {
      ERR_clear_error();
      return SSL_write(tls_, text.data(), static_cast<int>(text.size())) > 0;
    }));
  }
  /// All that comes until this text is in it, or the connection ends.
  std::string hear(const std::string& end) {
    std::size_t from = 0;
    pump_until(loop_, [&] {
      const bool found = heard_.find(end, from) != std::string::npos;
      from = heard_.size() - std::min(heard_.size(), end.size());
      return found || !listen();
    });
    return std::exchange(heard_, {});
  }
  /// As when the browser's window is closed.
  void shut_down() {
    SSL_shutdown(tls_);
    boost::system::error_code ignored;
    socket_.shutdown(boost::asio::ip::tcp::socket::shutdown_both, ignored);
  }
  /// True: the server ends the connection, and says nothing before.
  bool is_dropped() { return hear("never").empty() && ended; }

  /// RFC 6455, 5.2, masked with zeros; `first`: FIN and the opcode.
  void say_frame(unsigned first, const std::string& payload) {
    std::string out(1, static_cast<char>(first));
    out += static_cast<char>(0x80U | (payload.size() < 126 ? payload.size() : 126U));
    if (payload.size() >= 126) {
      out += static_cast<char>(payload.size() >> 8U);
      out += static_cast<char>(payload.size() & 0xffU);
    }
    say(out + std::string(4, '\0') + payload);
  }
  WebSocketFrame hear_frame() {
    REQUIRE(pump_until(loop_, [&] { return frame_size() > 0 || !listen(); }));
    const std::size_t size = frame_size();
    REQUIRE(size > 0);
    const WebSocketFrame out{static_cast<unsigned char>(heard_[0]) & 0x0fU,
                             heard_.substr(frame_head(), size - frame_head())};
    heard_.erase(0, size);
    return out;
  }
  bool ended = false;

 private:
  static SSL_CTX* context() {
    static const std::unique_ptr<SSL_CTX, void (*)(SSL_CTX*)> made(SSL_CTX_new(TLS_client_method()), SSL_CTX_free);
    return made.get();
  }
  /// Reads what is there; false: the connection has ended.
  bool listen() {
    char buffer[16384];
    int got = 0;
    ERR_clear_error();  // the server's errors are of the same thread
    while ((got = SSL_read(tls_, buffer, sizeof buffer)) > 0) heard_.append(buffer, static_cast<std::size_t>(got));
    const int error = SSL_get_error(tls_, got);
    ended = error != SSL_ERROR_WANT_READ && error != SSL_ERROR_WANT_WRITE;
    return !ended;
  }
  [[nodiscard]] unsigned byte_at(std::size_t at) const { return static_cast<unsigned char>(heard_[at]); }
  [[nodiscard]] std::size_t frame_head() const { return byte_at(1) == 126 ? 4 : 2; }
  /// Of a frame below 64 kB that is there whole; 0: none is.
  [[nodiscard]] std::size_t frame_size() const {
    if (heard_.size() < 2 || heard_.size() < frame_head()) return 0;
    const std::size_t size = frame_head() + (byte_at(1) == 126 ? byte_at(2) * 256 + byte_at(3) : byte_at(1));
    return heard_.size() < size ? 0 : size;
  }

  boost::asio::io_context& loop_;
  boost::asio::ip::tcp::socket socket_;
  SSL* tls_ = nullptr;
  std::string heard_;
};

struct ServerFixture {
  explicit ServerFixture(HttpServerSettings settings = {}) {
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
  bool until(const std::function<bool()>& condition) { return pump_until(loop, condition); }
  /// The server has no connection any more, a minute from now at the latest.
  bool until_alone() {
    return until([&] { return server->connections() == 0; });
  }

  TemporaryFolder folder;
  boost::asio::io_context loop;
  EchoHandler handler;
  std::unique_ptr<HttpServer> server;
};

inline std::string get(const std::string& target, const std::string& more = "") {
  return "GET " + target + " HTTP/1.1\r\nHost: localhost\r\n" + more + "\r\n";
}
/// True: the client asks for that path, and is answered.
inline bool is_served(TlsClient& client, const std::string& path = "/a") {
  client.say(get(path));
  return client.hear(path + " ").starts_with("HTTP/1.1 200");
}

inline std::string post(const std::string& target, const std::string& headers, const std::string& body = "") {
  return "POST " + target + " HTTP/1.1\r\nHost: localhost\r\n" + headers + "\r\n\r\n" + body;
}

/// Defaults, but for one of the times.
inline HttpServerSettings with_time(Duration HttpTimes::*which, Duration time) {
  HttpServerSettings out;
  out.times.*which = time;
  return out;
}

}  // namespace trb::gateway
