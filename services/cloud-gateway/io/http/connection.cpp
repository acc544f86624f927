#include "services/cloud-gateway/io/http/connection.hpp"

#include <poll.h>

#include <array>
#include <boost/asio/io_context.hpp>
#include <boost/asio/ip/tcp.hpp>
#include <boost/asio/ssl/context.hpp>
#include <boost/asio/write.hpp>
#include <boost/beast/core/flat_buffer.hpp>
#include <boost/beast/ssl/ssl_stream.hpp>
#include <boost/beast/websocket/stream.hpp>

#include "services/cloud-gateway/io/http/body_reader.hpp"
#include "services/cloud-gateway/io/http/deadline.hpp"
#include "services/cloud-gateway/io/http/reply_head.hpp"
#include "services/cloud-gateway/io/http/request_parser.hpp"

namespace trb::gateway {
namespace {

namespace asio = boost::asio;
namespace beast = boost::beast;
namespace websocket = beast::websocket;
using tcp = asio::ip::tcp;
using Problem = boost::system::error_code;
/// With the executor's own type: asking it costs nothing.
using Socket = asio::basic_stream_socket<tcp, asio::io_context::executor_type>;
using Tls = beast::ssl_stream<Socket>;
using SteadyClock = std::chrono::steady_clock;

/// A read: 128 of them are the largest body; a thousand connections have 8 MB of such buffers.
constexpr std::size_t kReadSize = 8192;
/// A body that is written in one piece with its head; to copy it costs less than a second piece.
constexpr std::size_t kCopied = 4096;
/// A control frame has 125 bytes, the code takes two (RFC 6455, 5.5).
constexpr std::size_t kMaxReason = 123;
constexpr std::string_view kContinue = "HTTP/1.1 100 Continue\r\n\r\n";

UtcTime utc_now() {
  const auto since = std::chrono::system_clock::now().time_since_epoch();
  return {std::chrono::duration_cast<std::chrono::nanoseconds>(since).count()};
}

// ---- WebSocket

class WebSocketConnection final : public Connection,
                                  public WebSocketOut,
                                  public std::enable_shared_from_this<WebSocketConnection> {
 public:
  WebSocketConnection(Tls stream, ConnectionOwner& owner, ConnectionId id, std::shared_ptr<WebSocketIn> in);
  void start(const ReadHead& head);

  [[nodiscard]] std::optional<SteadyClock::time_point> idle_since() const override { return std::nullopt; }
  void finish() override { close(websocket::going_away, "the gateway stops"); }
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

// ---- HTTP

class HttpConnection final : public Connection, public std::enable_shared_from_this<HttpConnection> {
 public:
  HttpConnection(Socket socket, asio::ssl::context& tls, ConnectionOwner& owner, const Accepted& accepted)
      : stream_(std::move(socket), tls),
        owner_(&owner),
        id_(accepted.id),
        source_(accepted.source),
        deadline_(stream_.get_executor()) {}
  void start();

  [[nodiscard]] std::optional<SteadyClock::time_point> idle_since() const override;
  void finish() override;
  void abort() override;
  void on_deadline();

 private:
  /// -         | accepted                                   | handshake
  /// handshake | TLS is agreed                              | waiting
  /// waiting   | the first bytes of a request, not all      | head
  /// waiting, head | the headers are there; a body follows  | body
  /// waiting, head | the headers are there; no body         | answering
  /// waiting, head | an upgrade that the handler takes      | ended: a WebSocketConnection goes on
  /// body      | the body is there                          | answering
  /// answering | the handler's reply; or 60 s: 503          | replying
  /// waiting, head, body | refused, or too slow: 408      | replying
  /// replying  | it is written, and the connection persists | waiting
  /// replying  | it is written                              | leaving
  /// leaving   | the client has closed it                   | ended
  /// any       | the connection fails, or its time is over  | ended
  enum class Phase : std::uint8_t { handshake, waiting, head, body, answering, replying, leaving, ended };

  void enter(Phase phase);
  [[nodiscard]] Duration time_of(Phase phase) const;
  void on_handshake(Problem problem);
  void wait_for_request();
  void read();
  void on_read(Problem problem, std::size_t count);
  void take_input();
  void take_head();
  void on_head();
  void begin_body();
  void take_body();
  void upgrade();
  void ask_handler();
  void watch_client();
  void look_at_client(Problem problem, std::uint64_t turn);
  [[nodiscard]] bool has_hung_up();
  void on_reply(std::uint64_t turn, HttpReply reply);
  void refuse(const HttpFault& fault);
  void send(HttpReply reply, bool keep_alive);
  void write();
  void on_written(Problem problem);
  void leave();
  void drain(Problem problem);
  void close();
  void end();

  Tls stream_;
  ConnectionOwner* owner_;
  ConnectionId id_;
  std::string source_;
  Deadline deadline_;
  Phase phase_ = Phase::handshake;
  SteadyClock::time_point waiting_since_{};
  std::uint64_t turn_ = 0;  ///< the request's number: a reply to an earlier one is late
  bool is_late_ = false;    ///< the time for the request is over
  bool keep_alive_ = false;
  std::array<char, kReadSize> chunk_{};
  std::string input_;
  std::optional<RequestParser> parser_;
  ReadHead head_;
  std::shared_ptr<ClientWatch> client_;  ///< while the handler answers
  BodyReader body_ = BodyReader::of_size(0);
  std::string reply_head_;
  std::shared_ptr<const Bytes> reply_body_;
};

void HttpConnection::start() {
  waiting_since_ = SteadyClock::now();
  enter(Phase::handshake);
  stream_.async_handshake(asio::ssl::stream_base::server,
                          [self = shared_from_this()](Problem problem) { self->on_handshake(problem); });
}

Duration HttpConnection::time_of(Phase phase) const {
  const HttpTimes& times = owner_->times();
  switch (phase) {
    case Phase::waiting:
      return turn_ == 0 ? times.head : times.idle;
    case Phase::body:
      return times.body;
    case Phase::answering:
      return times.answer;
    case Phase::replying:
      return times.reply;
    case Phase::leaving:
      return times.linger;
    default:
      return times.head;
  }
}

void HttpConnection::enter(Phase phase) {
  phase_ = phase;
  is_late_ = false;
  deadline_.set(time_of(phase), shared_from_this());
}

void HttpConnection::on_deadline() {
  if (phase_ == Phase::answering)
    return refuse({503, "no_answer", "the gateway found no answer in time", "try again; see the gateway's log"});
  if ((phase_ != Phase::head && phase_ != Phase::body) || is_late_) return end();
  // The read ends, and the client is told why. If the read is not the one that waits, the next deadline ends it.
  is_late_ = true;
  deadline_.set(owner_->times().linger, shared_from_this());
  Problem ignored;
  stream_.next_layer().cancel(ignored);
}

void HttpConnection::on_handshake(Problem problem) {
  if (phase_ == Phase::ended) return;
  if (problem) return end();
  wait_for_request();
}

void HttpConnection::wait_for_request() {
  if (owner_->is_stopping()) return end();
  waiting_since_ = SteadyClock::now();
  parser_.emplace();
  head_ = {};
  enter(Phase::waiting);
  take_input();
}

void HttpConnection::read() {
  stream_.async_read_some(asio::buffer(chunk_), [self = shared_from_this()](Problem problem, std::size_t count) {
    self->on_read(problem, count);
  });
}

void HttpConnection::on_read(Problem problem, std::size_t count) {
  if (phase_ == Phase::ended) return;
  if (problem && is_late_)
    return refuse({408, "too_slow", "the request did not arrive in time", "try again on a better network"});
  if (problem) return end();
  input_.append(chunk_.data(), count);
  take_input();
}

void HttpConnection::take_input() {
  if (input_.empty()) return read();
  phase_ == Phase::body ? take_body() : take_head();
}

void HttpConnection::take_head() {
  switch (parser_->feed(input_)) {
    case RequestParser::State::more:
      if (phase_ == Phase::waiting) enter(Phase::head);
      return read();
    case RequestParser::State::fault:
      return refuse(parser_->fault());
    case RequestParser::State::done:
      return on_head();
  }
}

void HttpConnection::on_head() {
  auto read = read_head(parser_->take());
  if (const auto* fault = std::get_if<HttpFault>(&read)) return refuse(*fault);
  head_ = std::get<ReadHead>(std::move(read));
  head_.request.source = source_;
  if (head_.websocket_key) return upgrade();
  if (head_.body_size > kMaxRequestBody)
    return refuse({413, "body_too_large", "a body over " + std::to_string(kMaxRequestBody) + " bytes", "send less"});
  if (!head_.is_chunked && head_.body_size == 0) {
    body_ = BodyReader::of_size(0);
    return ask_handler();
  }
  if (auto refused = owner_->handler().before_body(head_.request, head_.body_size))
    return send(std::move(*refused), false);
  begin_body();
}

void HttpConnection::begin_body() {
  body_ = head_.is_chunked ? BodyReader::of_chunks(kMaxRequestBody)
                           : BodyReader::of_size(static_cast<std::size_t>(head_.body_size));
  enter(Phase::body);
  if (!head_.expects_continue || !input_.empty()) return take_body();
  reply_head_ = kContinue;
  write();
}

void HttpConnection::take_body() {
  switch (body_.feed(input_)) {
    case BodyReader::State::more:
      return read();
    case BodyReader::State::done:
      return ask_handler();
    case BodyReader::State::too_large:
      return refuse({413, "body_too_large", "chunks over " + std::to_string(kMaxRequestBody) + " bytes", "send less"});
    case BodyReader::State::malformed:
      return refuse(bad_request("a chunk that is none", "see RFC 9112, 7.1"));
  }
}

void HttpConnection::upgrade() {
  if (!input_.empty()) return refuse(bad_request("bytes before the upgrade was agreed", "wait for 101"));
  if (owner_->is_stopping()) return refuse({503, "stopping", "the gateway stops", "try again in some seconds"});
  auto taken = owner_->handler().on_upgrade(head_.request);
  if (auto* refused = std::get_if<HttpReply>(&taken)) return send(std::move(*refused), true);
  phase_ = Phase::ended;
  deadline_.cancel();
  const auto next = std::make_shared<WebSocketConnection>(std::move(stream_), *owner_, id_,
                                                          std::get<std::shared_ptr<WebSocketIn>>(std::move(taken)));
  std::exchange(owner_, nullptr)->replace(id_, next);
  next->start(head_);
}

void HttpConnection::ask_handler() {
  head_.request.body = body_.take();
  phase_ = Phase::answering;
  client_ = std::make_shared<ClientWatch>();
  head_.request.client = client_;
  const std::uint64_t turn = turn_;
  owner_->handler().on_request(std::move(head_.request), [weak = weak_from_this(), turn](HttpReply reply) {
    if (const auto self = weak.lock()) self->on_reply(turn, std::move(reply));
  });
  // Most handlers have answered by now.
  if (phase_ != Phase::answering || turn != turn_) return;
  enter(Phase::answering);
  watch_client();
}

/// Nothing is read while the handler answers: the socket alone tells that its client is gone.
void HttpConnection::watch_client() {
  stream_.next_layer().async_wait(Socket::wait_read, [self = shared_from_this(), turn = turn_](Problem problem) {
    self->look_at_client(problem, turn);
  });
}

/// Bytes may be the end of TLS, whose FIN follows, or the next request: then nobody looks any more.
void HttpConnection::look_at_client(Problem problem, std::uint64_t turn) {
  if (problem || phase_ != Phase::answering || turn != turn_) return;
  if (client_->on_left && has_hung_up()) end();
}

bool HttpConnection::has_hung_up() {
  pollfd look{stream_.next_layer().native_handle(), POLLRDHUP, 0};
  return ::poll(&look, 1, 0) > 0 && (look.revents & (POLLRDHUP | POLLHUP | POLLERR)) != 0;
}

void HttpConnection::on_reply(std::uint64_t turn, HttpReply reply) {
  if (phase_ == Phase::answering && turn == turn_) send(std::move(reply), true);
}

void HttpConnection::refuse(const HttpFault& fault) {
  HttpReply reply = owner_->handler().refusal(fault.status, fault.code, fault.detail, fault.hint);
  if (fault.status == 426) reply.headers.emplace_back("Sec-WebSocket-Version", "13");  // RFC 6455, 4.4
  send(std::move(reply), false);
}

/// `keep_alive`: all of the request was read.
void HttpConnection::send(HttpReply reply, bool keep_alive) {
  client_ = nullptr;
  keep_alive_ = keep_alive && head_.keep_alive && !owner_->is_stopping();
  auto head = reply_head(reply, keep_alive_, utc_now());
  if (!head) {
    reply = owner_->handler().refusal(500, "bad_reply", head.error().what, "tell the gateway's maintainers");
    head = reply_head(reply, keep_alive_, utc_now());
  }
  if (!head) return end();
  reply_head_ = std::move(*head);
  if (!head_.is_head && may_have_body(reply.status)) reply_body_ = std::move(reply.body);
  ++turn_;
  enter(Phase::replying);
  write();
}

void HttpConnection::write() {
  const auto written = [self = shared_from_this()](Problem problem, std::size_t) { self->on_written(problem); };
  if (reply_body_ && reply_body_->size() <= kCopied) reply_head_.append(*std::exchange(reply_body_, nullptr));
  if (!reply_body_) return asio::async_write(stream_, asio::buffer(reply_head_), written);
  // No array: in Boost 1.74 an array of two has an empty buffer in front when the head is sent, and of that flat_stream
  // writes nothing and says that all is done: a reply over 16 kB would end with its head.
  const std::vector<asio::const_buffer> buffers{{reply_head_.data(), reply_head_.size()},
                                                {reply_body_->data(), reply_body_->size()}};
  asio::async_write(stream_, buffers, written);
}

void HttpConnection::on_written(Problem problem) {
  if (phase_ == Phase::ended) return;
  reply_body_ = nullptr;
  if (problem) return end();
  if (phase_ == Phase::body) return take_input();  // it was the 100
  keep_alive_ ? wait_for_request() : leave();
}

/// A connection that is closed with bytes unread is reset, and the reply may be lost with it (RFC 9112, 9.6).
void HttpConnection::leave() {
  enter(Phase::leaving);
  stream_.async_shutdown([self = shared_from_this()](Problem) {
    if (self->phase_ == Phase::ended) return;
    Problem ignored;
    self->stream_.next_layer().shutdown(tcp::socket::shutdown_send, ignored);
    self->drain({});
  });
}

void HttpConnection::drain(Problem problem) {
  if (phase_ == Phase::ended) return;
  if (problem) return end();
  stream_.next_layer().async_read_some(asio::buffer(chunk_),
                                       [self = shared_from_this()](Problem next, std::size_t) { self->drain(next); });
}

void HttpConnection::close() {
  phase_ = Phase::ended;
  deadline_.cancel();
  Problem ignored;
  stream_.next_layer().close(ignored);
  const auto client = std::exchange(client_, nullptr);
  if (client != nullptr && client->on_left) client->on_left();
}

void HttpConnection::end() {
  const auto self = shared_from_this();
  if (phase_ == Phase::ended) return;
  close();
  std::exchange(owner_, nullptr)->ended(id_);
}

std::optional<SteadyClock::time_point> HttpConnection::idle_since() const {
  const bool waits = phase_ == Phase::waiting || phase_ == Phase::handshake;
  return waits ? std::optional(waiting_since_) : std::nullopt;
}

void HttpConnection::finish() {
  if (phase_ == Phase::handshake || phase_ == Phase::waiting) end();
}

void HttpConnection::abort() {
  owner_ = nullptr;
  if (phase_ != Phase::ended) close();
}

}  // namespace

std::shared_ptr<Connection> start_connection(asio::io_context& loop, asio::ssl::context& tls, ConnectionOwner& owner,
                                             Accepted accepted) {
  Socket socket(loop);
  Problem ignored;
  socket.assign(accepted.is_v6 ? tcp::v6() : tcp::v4(), accepted.socket, ignored);
  auto connection = std::make_shared<HttpConnection>(std::move(socket), tls, owner, accepted);
  connection->start();
  return connection;
}

}  // namespace trb::gateway
