// HTTP/1.1 and WebSocket over TLS for the API, on the loop of an io_context.
#pragma once

#include <cstdint>
#include <memory>
#include <string>

#include "common/base/result.hpp"
#include "services/cloud-gateway/io/http/exchange.hpp"

namespace boost::asio {
class io_context;
}

namespace trb::gateway {

struct HttpServerSettings {
  std::string address = "127.0.0.1";  ///< a number
  std::uint16_t port = 8443;          ///< 0: any free one
  std::string certificate_file;       ///< PEM, the chain
  std::string key_file;               ///< PEM
  std::size_t max_connections = 1024;
  std::size_t max_of_source = 64;  ///< connections of one address (for IPv6: one /64)
};

/// Bounds: 8 kB of headers; 10 s for the handshake and the headers; bodies as the handler allows, 1 MiB at most, 20 s;
/// 60 s between requests; 20 s for a reply to be read. Over max_connections new ones are closed at once, so the oldest
/// that waits for a request (no request under way, not a WebSocket) makes room first. A WebSocket that does not answer
/// a ping within 30 s is closed.
class HttpServer {
 public:
  /// Listens from now on. `loop` and `handler` must outlive it. Errors: io_error (address, port), bad_value
  /// (certificate or key that cannot be read or do not fit).
  static Result<std::unique_ptr<HttpServer>> open(boost::asio::io_context& loop, const HttpServerSettings& settings,
                                                  HttpHandler& handler);
  HttpServer() = default;
  HttpServer(const HttpServer&) = delete;
  HttpServer& operator=(const HttpServer&) = delete;
  virtual ~HttpServer() = default;

  [[nodiscard]] virtual std::uint16_t port() const = 0;
  [[nodiscard]] virtual std::size_t connections() const = 0;
  /// Stops listening; ends WebSockets with 1001 and idle connections; replies under way are finished.
  virtual void stop() = 0;
};

}  // namespace trb::gateway
