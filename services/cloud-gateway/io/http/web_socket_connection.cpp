#include "services/cloud-gateway/io/http/web_socket_connection.hpp"

#include <algorithm>
#include <boost/beast/core/flat_buffer.hpp>
#include <boost/beast/websocket/stream.hpp>

#include "services/cloud-gateway/io/http/deadline.hpp"
#include "services/cloud-gateway/io/http/reply_head.hpp"

namespace trb::gateway {
namespace {

namespace asio = boost::asio;
namespace beast = boost::beast;
namespace websocket = beast::websocket;

/// A control frame has 125 bytes, the code takes two (RFC 6455, 5.5).
constexpr std::size_t kMaxReason = 123;

class WebSocketConnection final : public Connection,
                                  public WebSocketOut,
                                  public std::enable_shared_from_this<WebSocketConnection> {
 public:
  WebSocketConnection(Tls stream, ConnectionOwner& owner, ConnectionId id, std::shared_ptr<WebSocketIn> in);
  void start(const ReadHead& head);

  [[nodiscard]] std::optional<std::chrono::steady_clock::time_point> idle_since() const override {
    return std::nullopt;
  }
  void finish() override;
  void abort() override;
  void send(std::vector<std::shared_ptr<const Bytes>> parts) override;
  void close(std::uint16_t code, const std::string& reason) override;
  void on_deadline() { cut_off(); }

 private:
  void on_accepted(Problem problem);
  void read();
  void on_read(Problem problem);
  void on_sent(Problem problem);
  void start_close();
  void on_ended(Problem problem);
  void cut_off();
  void end();

  websocket::stream<Tls, false> stream_;
  ConnectionOwner* owner_;
  ConnectionId id_;
  std::shared_ptr<WebSocketIn> in_;
  Deadline deadline_;
  /// Beast wants room left even for an empty last fragment; the bound is read_message_max.
  beast::flat_buffer message_{2 * kMaxWebSocketMessage};
  std::vector<std::shared_ptr<const Bytes>> sending_;
  std::optional<websocket::close_reason> reason_;  ///< close() was called
  bool open_ = false;
};

WebSocketConnection::WebSocketConnection(Tls stream, ConnectionOwner& owner, ConnectionId id,
                                         std::shared_ptr<WebSocketIn> in)
    : stream_(std::move(stream)), owner_(&owner), id_(id), in_(std::move(in)), deadline_(stream_.get_executor()) {
  stream_.set_option(websocket::stream_base::timeout{owner.times().head, owner.times().ping, true});
  stream_.set_option(websocket::stream_base::decorator([](websocket::response_type& reply) {
    for (const auto& [name, value] : security_headers())
      reply.insert({name.data(), name.size()}, {value.data(), value.size()});
    reply.set(beast::http::field::server, "-");  // else Beast says its version
  }));
  stream_.read_message_max(kMaxWebSocketMessage);
  stream_.auto_fragment(false);
  stream_.text(true);
}

void WebSocketConnection::start(const ReadHead& head) {
  beast::http::request<beast::http::empty_body> request{beast::http::verb::get, head.request.target, 11};
  request.set(beast::http::field::host, head.request.host);
  request.set(beast::http::field::connection, "upgrade");
  request.set(beast::http::field::upgrade, "websocket");
  request.set(beast::http::field::sec_websocket_key, *head.websocket_key);
  request.set(beast::http::field::sec_websocket_version, "13");
  stream_.async_accept(request, [self = shared_from_this()](Problem problem) { self->on_accepted(problem); });
}

void WebSocketConnection::finish() {
  close(websocket::going_away, "the gateway stops");
}

void WebSocketConnection::on_accepted(Problem problem) {
  if (problem || in_ == nullptr) return end();
  open_ = true;
  if (reason_) return start_close();
  const auto in = in_;
  in->on_open(shared_from_this());
  read();
}

void WebSocketConnection::read() {
  if (reason_ || in_ == nullptr) return;
  message_.clear();
  stream_.async_read(message_, [self = shared_from_this()](Problem problem, std::size_t) { self->on_read(problem); });
}

void WebSocketConnection::on_read(Problem problem) {
  if (in_ == nullptr) return;
  if (problem) return reason_ ? void() : end();  // else the close goes on, and ends it
  if (!stream_.got_text()) close(websocket::unknown_data, "text messages only");
  if (reason_) return;
  const auto in = in_;
  in->on_message({static_cast<const char*>(message_.data().data()), message_.size()});
  read();
}

void WebSocketConnection::send(std::vector<std::shared_ptr<const Bytes>> parts) {
  if (in_ == nullptr || reason_) return;
  sending_ = std::move(parts);
  std::vector<asio::const_buffer> buffers;
  for (const auto& part : sending_) buffers.emplace_back(part->data(), part->size());
  deadline_.set(owner_->times().reply, shared_from_this());
  stream_.async_write(buffers, [self = shared_from_this()](Problem problem, std::size_t) { self->on_sent(problem); });
}

void WebSocketConnection::on_sent(Problem problem) {
  sending_.clear();
  if (in_ == nullptr || reason_) return;
  deadline_.cancel();
  if (problem) return cut_off();
  const auto in = in_;
  in->on_sent();
}

void WebSocketConnection::close(std::uint16_t code, const std::string& reason) {
  if (in_ == nullptr || reason_) return;
  std::size_t size = std::min(reason.size(), kMaxReason);
  // Not in the middle of a character of UTF-8.
  while (size < reason.size() && size > 0 && (static_cast<unsigned char>(reason[size]) & 0xc0U) == 0x80U) --size;
  reason_.emplace(static_cast<websocket::close_code>(code), beast::string_view(reason.data(), size));
  if (open_) start_close();
}

void WebSocketConnection::start_close() {
  // The message that is being sent comes first, then both sides say that they close.
  deadline_.set(owner_->times().reply, shared_from_this());
  stream_.async_close(*reason_, [self = shared_from_this()](Problem) { self->end(); });
}

void WebSocketConnection::cut_off() {
  Problem ignored;
  beast::get_lowest_layer(stream_).close(ignored);
  end();
}

void WebSocketConnection::end() {
  const auto self = shared_from_this();
  auto* const owner = std::exchange(owner_, nullptr);
  const auto in = std::exchange(in_, nullptr);
  if (in == nullptr) return;
  deadline_.cancel();
  Problem ignored;
  beast::get_lowest_layer(stream_).close(ignored);
  in->on_closed();
  if (owner != nullptr) owner->ended(id_);
}

void WebSocketConnection::abort() {
  owner_ = nullptr;
  end();
}

}  // namespace

std::shared_ptr<Connection> start_web_socket(Tls stream, ConnectionOwner& owner, ConnectionId id,
                                             std::shared_ptr<WebSocketIn> in, const ReadHead& head) {
  auto connection = std::make_shared<WebSocketConnection>(std::move(stream), owner, id, std::move(in));
  connection->start(head);
  return connection;
}

}  // namespace trb::gateway
