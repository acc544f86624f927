// HTTP/1.1 and WebSocket over TLS for the API, on the loop of an io_context.
#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "common/base/result.hpp"
#include "common/base/time.hpp"
#include "services/cloud-gateway/io/http/exchange.hpp"

namespace boost::asio {
class io_context;
}

namespace trb::gateway {

/// The request line and the headers of a request. Browsers send below 2 kB; this is what most servers take.
constexpr std::size_t kMaxRequestHead = 8192;
/// Bodies of requests: the longest of ours, a scenario, is far below.
constexpr std::size_t kMaxRequestBody = 1U << 20U;

/// How long a client may take. A slow one holds a connection, of which there are max_connections; so each wait ends.
/// Tests take milliseconds.
struct HttpTimes {
  /// For the TLS handshake: a slow mobile network takes 2 s, as for the headers.
  Duration handshake = std::chrono::seconds(10);
  /// For the first byte of the first request, then for the headers of each.
  Duration head = std::chrono::seconds(10);
  /// For a body: 1 MiB at 0.5 Mbit/s.
  Duration body = std::chrono::seconds(20);
  /// From a reply to the next request: browsers keep connections open for about that.
  Duration idle = std::chrono::seconds(60);
  /// For the handler's reply: longer than all of its own waits, so that only a lost one ends here (503).
  Duration answer = std::chrono::seconds(60);
  /// For a reply, or a message of a WebSocket, to be taken by the client.
  Duration reply = std::chrono::seconds(20);
  /// From the last reply until the connection is cut off: a client that still sends must be able to read it.
  Duration linger = std::chrono::seconds(2);
  /// Without any data from a WebSocket's client: it is pinged after half of that, and closed after all of it.
  Duration ping = std::chrono::seconds(30);
};

struct HttpServerSettings {
  std::string address = "127.0.0.1";  ///< a number
  std::uint16_t port = 8443;          ///< 0: any free one
  std::string certificate_file;       ///< PEM, the chain
  std::string key_file;               ///< PEM
  std::size_t max_connections = 1024;
  std::size_t max_of_source = 64;    ///< connections of one address (for IPv6: one /64)
  std::vector<std::string> proxies;  ///< numeric addresses that many people come by
  std::size_t max_of_proxy = 512;    ///< connections of one of them
  HttpTimes times{};
};

/// Bounds: kMaxRequestHead, kMaxRequestBody, HttpTimes. Over max_connections the one that has waited longest for a
/// request, or for the end of its handshake (no request under way, not a WebSocket), is closed; if there is none, the
/// new one. Over max_of_source, or max_of_proxy, the same among those of that address.
class HttpServer {
 public:
  /// Listens from now on. `loop` and `handler` must outlive it. Errors: io_error (address, port), bad_value
  /// (certificate or key that cannot be read or do not fit; an address that is no number).
  static Result<std::unique_ptr<HttpServer>> open(boost::asio::io_context& loop, const HttpServerSettings& settings,
                                                  HttpHandler& handler);
  HttpServer() = default;
  HttpServer(const HttpServer&) = delete;
  HttpServer& operator=(const HttpServer&) = delete;
  /// Cuts all connections off. WebSockets get their on_closed() now; after that the handler is not called any more.
  virtual ~HttpServer() = default;

  [[nodiscard]] virtual std::uint16_t port() const = 0;
  [[nodiscard]] virtual std::size_t connections() const = 0;
  /// Stops listening; ends WebSockets with 1001 and idle connections; requests under way are finished and answered. The
  /// loop has no more work of this server when connections() is 0, after the slowest time of HttpTimes at most.
  virtual void stop() = 0;
};

}  // namespace trb::gateway
