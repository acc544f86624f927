// What the HTTP server and the API exchange: requests, replies, and the two ends of a WebSocket. Plain data, no Beast.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <variant>
#include <vector>

#include "common/base/bytes.hpp"
#include "services/cloud-gateway/core/access/request_check.hpp"

namespace trb::gateway {

/// A request whose answer takes a while, and what to do if its client does not wait for it.
struct ClientWatch {
  /// Called once, if the client closes its connection before the reply. Whoever sets it gives up the reply.
  std::function<void()> on_left;
};

/// A request with its body. Header values are as sent; a header that is missing is nullopt, and one of these that is
/// repeated was refused before.
struct HttpRequest {
  std::string method;  ///< HEAD comes as GET: the server leaves the body of the reply out
  std::string target;
  std::string host;
  std::string source;                  ///< the client's address; for IPv6 its /64 ("2001:db8::/64")
  std::optional<std::string> session;  ///< the value of the cookie kSessionCookie
  std::optional<std::string> bearer;
  std::optional<std::string> origin;
  std::optional<std::string> csrf;
  std::optional<std::string> content_type;
  std::optional<std::string> if_match;
  std::optional<std::string> if_none_match;
  std::optional<std::string> idempotency_key;
  bool accepts_gzip = false;  ///< Accept-Encoding has it, and not with q=0
  Bytes body;
  std::shared_ptr<ClientWatch> client{};  ///< of a request that the handler answers; null: nobody looks

  /// Valid as long as this object.
  [[nodiscard]] RequestHead head() const;
};

/// `__Host-`: the browser takes it over TLS only, for this host and the whole path (RFC 6265bis).
constexpr std::string_view kSessionCookie = "__Host-trb";

struct HttpReply {
  int status = 200;
  std::string content_type = "application/json";
  std::vector<std::pair<std::string, std::string>> headers{};  ///< besides those that every reply has
  std::shared_ptr<const Bytes> body{};                         ///< null: none
};

/// Sends the reply. Called once, on the loop's thread, now or later; the client may have gone by then, and the server
/// too: then nothing happens, as for a second call.
using Reply = std::function<void(HttpReply)>;

/// A client's WebSocket, as the API sees it. All calls on the loop's thread.
class WebSocketOut {
 public:
  WebSocketOut() = default;
  WebSocketOut(const WebSocketOut&) = delete;
  WebSocketOut& operator=(const WebSocketOut&) = delete;
  virtual ~WebSocketOut() = default;
  /// A text message of these parts, one after the other; UTF-8. Call it only when nothing is being sent: on_sent()
  /// tells. A client that does not take it within HttpTimes::reply is dropped.
  virtual void send(std::vector<std::shared_ptr<const Bytes>> parts) = 0;
  /// Closes it with a code of RFC 6455, 7.4; on_closed() follows, on_message() and on_sent() do not. Over 123 bytes of
  /// the reason are cut off (5.5.1). A second call does nothing.
  virtual void close(std::uint16_t code, const std::string& reason) = 0;
};

/// What a WebSocket tells the API.
class WebSocketIn {
 public:
  WebSocketIn() = default;
  WebSocketIn(const WebSocketIn&) = delete;
  WebSocketIn& operator=(const WebSocketIn&) = delete;
  virtual ~WebSocketIn() = default;
  /// The client has the server's consent: messages may be sent.
  virtual void on_open(std::shared_ptr<WebSocketOut> out) = 0;
  /// A text message of kMaxWebSocketMessage at most; a longer one, or a binary one, closes the socket.
  virtual void on_message(BytesView text) = 0;
  /// All that was given to send() is with the kernel.
  virtual void on_sent() = 0;
  /// Called once, also if it never opened. Nothing follows; `out` must not be used any more.
  virtual void on_closed() = 0;
};
constexpr std::size_t kMaxWebSocketMessage = 4096;

/// The other side of the server.
class HttpHandler {
 public:
  HttpHandler() = default;
  HttpHandler(const HttpHandler&) = delete;
  HttpHandler& operator=(const HttpHandler&) = delete;
  virtual ~HttpHandler() = default;

  /// What to refuse before the body is read, such as a stranger's. nullopt: read it. Asked for every request with a
  /// body that is not longer than kMaxRequestBody; on_request() checks all.
  virtual std::optional<HttpReply> before_body(const HttpRequest& request) = 0;
  virtual void on_request(HttpRequest request, Reply reply) = 0;
  /// A request to become a WebSocket: the end that it talks to, or why not.
  virtual std::variant<std::shared_ptr<WebSocketIn>, HttpReply> on_upgrade(const HttpRequest& request) = 0;
  /// The server itself answers what is no HTTP, too large or too slow: a problem (RFC 9457) with this status.
  virtual HttpReply refusal(int status, const std::string& code, const std::string& detail,
                            const std::string& hint) = 0;
};

}  // namespace trb::gateway
