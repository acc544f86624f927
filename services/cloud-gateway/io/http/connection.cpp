#include "services/cloud-gateway/io/http/connection.hpp"

#include <poll.h>

#include <array>
#include <boost/asio/ssl/context.hpp>
#include <boost/asio/write.hpp>

#include "services/cloud-gateway/io/http/body_reader.hpp"
#include "services/cloud-gateway/io/http/deadline.hpp"
#include "services/cloud-gateway/io/http/reply_head.hpp"
#include "services/cloud-gateway/io/http/request_parser.hpp"
#include "services/cloud-gateway/io/http/stream.hpp"
#include "services/cloud-gateway/io/http/web_socket_connection.hpp"

namespace trb::gateway {
namespace {

namespace asio = boost::asio;
using Tcp = asio::ip::tcp;
using SteadyClock = std::chrono::steady_clock;

/// A read: 128 of them are the largest body; a thousand connections have 8 MB of such buffers.
constexpr std::size_t kReadSize = 8192;
/// A body that is written in one piece with its head; to copy it costs less than a second piece.
constexpr std::size_t kCopied = 4096;
constexpr std::string_view kContinue = "HTTP/1.1 100 Continue\r\n\r\n";

UtcTime utc_now() {
  const auto since = std::chrono::system_clock::now().time_since_epoch();
  return {std::chrono::duration_cast<std::chrono::nanoseconds>(since).count()};
}

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
  /// waiting, head | an upgrade that the handler takes      | ended: a WebSocket's connection goes on
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
    case Phase::handshake:
      return times.handshake;
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
  if (auto refused = owner_->handler().before_body(head_.request)) return send(std::move(*refused), false);
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
  auto next = start_web_socket(std::move(stream_), *owner_, id_,
                               std::get<std::shared_ptr<WebSocketIn>>(std::move(taken)), head_);
  std::exchange(owner_, nullptr)->replace(id_, std::move(next));
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
    self->stream_.next_layer().shutdown(Tcp::socket::shutdown_send, ignored);
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
  socket.assign(accepted.is_v6 ? Tcp::v6() : Tcp::v4(), accepted.socket, ignored);
  auto connection = std::make_shared<HttpConnection>(std::move(socket), tls, owner, accepted);
  connection->start();
  return connection;
}

}  // namespace trb::gateway
