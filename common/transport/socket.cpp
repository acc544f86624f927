#include "common/transport/socket.hpp"

#include <sys/stat.h>

#include <cerrno>
#include <cstdlib>
#include <stdexcept>

#include "common/base/on_wire.hpp"

namespace trb {
namespace {

constexpr std::uint64_t kFirstIoThread = 1;  // masks: a bit for each
constexpr std::uint64_t kLaneIoThread = 2;
constexpr int kEnforceDomain = 93;    // ZMQ_ZAP_ENFORCE_DOMAIN, a draft name in Debian's header
constexpr int kZeroCopyReceive = 10;  // ZMQ_ZERO_COPY_RECV, another draft name
constexpr std::int64_t kMaxMessage = (1 << 20) + 1024;

zmq::socket_t make(Context& context, zmq::socket_type type) {
  zmq::socket_t socket(context.zmq(), type);
  socket.set(zmq::sockopt::affinity, kFirstIoThread);
  socket.set(zmq::sockopt::linger, 0);
  socket.set(zmq::sockopt::sndhwm, kHighWaterMark);
  socket.set(zmq::sockopt::rcvhwm, kReceiveHighWaterMark);
  socket.set(zmq::sockopt::maxmsgsize, kMaxMessage);
  return socket;
}

/// A connection whose other end lost power, or moved, holds a descriptor until the kernel's keep-alives have failed.
void watch_connections(zmq::socket_t& socket) {
  socket.set(zmq::sockopt::tcp_keepalive, 1);
  socket.set(zmq::sockopt::tcp_keepalive_idle, 15);
  socket.set(zmq::sockopt::tcp_keepalive_intvl, 5);
  socket.set(zmq::sockopt::tcp_keepalive_cnt, 3);
}

/// A lane holds little, and shares nothing with the links: what waits in it must not delay them.
void be_lane(zmq::socket_t& socket) {
  socket.set(zmq::sockopt::affinity, kLaneIoThread);
  socket.set(zmq::sockopt::sndhwm, kLaneHighWaterMark);
  socket.set(zmq::sockopt::rcvhwm, kLaneReceiveHighWaterMark);
  socket.set(zmq::sockopt::sndbuf, 256 << 10);
  socket.set(zmq::sockopt::rcvbuf, 256 << 10);
  watch_connections(socket);
}

/// Clients must show a key that ZAP lets in; a handshake takes 2 s at most.
void be_curve_server(zmq::socket_t& socket, const CurveKeys& keys, std::string_view domain) {
  socket.set(zmq::sockopt::curve_server, true);
  socket.set(zmq::sockopt::curve_secretkey, keys.secret_key);
  socket.set(zmq::sockopt::zap_domain, std::string(domain));
  const int on = 1;
  if (zmq_setsockopt(socket.handle(), kEnforceDomain, &on, sizeof on) != 0) throw zmq::error_t();
  socket.set(zmq::sockopt::handshake_ivl, 2000);
}

void be_curve_client(zmq::socket_t& socket, const CurveClient& curve) {
  socket.set(zmq::sockopt::curve_publickey, curve.own.public_key);
  socket.set(zmq::sockopt::curve_secretkey, curve.own.secret_key);
  socket.set(zmq::sockopt::curve_serverkey, curve.server_key);
}

/// On a bus over TCP a container that was cut off must not keep its place: its connection ends after 6 s of silence.
void watch_bus(zmq::socket_t& socket) {
  socket.set(zmq::sockopt::heartbeat_ivl, 2000);
  socket.set(zmq::sockopt::heartbeat_timeout, 6000);
}

std::string hint_for(const zmq::error_t& problem) {
  if (problem.num() == EADDRINUSE) return "stop the other process on that address, or take another one";
  return problem.num() == EMFILE ? "raise the limit of open files (ulimit -n)" : "";
}

/// What binding it is about.
std::string bound(const std::string& endpoint) {
  return endpoint.empty() ? "a socket that others dial" : endpoint + ": cannot bind";
}

Error failed(const std::string& what, const zmq::error_t& problem) {
  return fail(Errc::io_error, what + ": " + problem.what(), hint_for(problem));
}

/// What `does` returns, or why libzmq refused it; `what` says what it was about.
template <class Out, class Does>
Out or_error(const std::string& what, const Does& does) {
  try {
    return does();
  } catch (const zmq::error_t& problem) {
    return failed(what, problem);
  }
}

/// At startup a failure to create something ends the program.
template <class Make>
auto at_start(const std::string& what, const Make& make) {
  try {
    return make();
  } catch (const zmq::error_t& problem) {
    throw std::runtime_error(what + ": " + problem.what());
  }
}

zmq::context_t make_context(int io_threads) {
  zmq::context_t context(io_threads);
  // Each of a thousand links takes six: its own and its lane's, and two monitors for each.
  context.set(zmq::ctxopt::max_sockets, 8192);
  context.set(zmq::ctxopt::ipv6, 1);
  // Otherwise a small message that waits keeps the 18 kB buffer alive that it was read into.
  if (zmq_ctx_set(context.handle(), kZeroCopyReceive, 0) != 0) throw zmq::error_t();
  return context;
}

/// A server of a node's own bus: with keys on a bus over TCP.
void be_bus_server(zmq::socket_t& socket, const std::string& endpoint, const CurveKeys* curve) {
  socket.set(zmq::sockopt::sndhwm, kBusHighWaterMark);
  if (curve != nullptr) {
    be_curve_server(socket, *curve, kBusDomain);
    watch_bus(socket);
  }
  if (!endpoint.empty()) socket.bind(endpoint);
}

zmq::socket_t make_bus_client(Context& context, const std::string& endpoint, const CurveClient* curve) {
  zmq::socket_t socket = make(context, zmq::socket_type::dealer);
  if (curve != nullptr) {
    be_curve_client(socket, *curve);
    watch_bus(socket);
  }
  socket.set(zmq::sockopt::immediate, true);
  socket.set(zmq::sockopt::reconnect_ivl, 50);
  socket.set(zmq::sockopt::reconnect_ivl_max, 500);
  if (!endpoint.empty()) socket.connect(endpoint);
  return socket;
}

zmq::socket_t make_dialler(Context& context, const CurveKeys& keys, BytesView server_key) {
  zmq::socket_t socket = make(context, zmq::socket_type::dealer);
  // One connection is one link: libzmq must never reconnect behind the core's back.
  socket.set(zmq::sockopt::immediate, true);
  socket.set(zmq::sockopt::rcvhwm, kLinkReceiveHighWaterMark);
  socket.set(zmq::sockopt::reconnect_ivl, -1);
  socket.set(zmq::sockopt::connect_timeout, 1000);
  watch_connections(socket);
  socket.set(zmq::sockopt::handshake_ivl, 2000);
  // The last messages before a close, a Goodbye or the reason of a refusal, are still sent.
  socket.set(zmq::sockopt::linger, 200);
  be_curve_client(socket, {keys, Bytes(server_key)});
  return socket;
}

zmq::socket_t make_tap_client(Context& context, const std::string& endpoint, const CurveClient* curve) {
  zmq::socket_t socket = make(context, zmq::socket_type::sub);
  if (curve != nullptr) be_curve_client(socket, *curve);
  socket.set(zmq::sockopt::subscribe, "");
  socket.connect(endpoint);
  return socket;
}

zmq::socket_t make_lane_server(Context& context, const CurveKeys& keys) {
  zmq::socket_t socket = make(context, zmq::socket_type::xpub);
  be_lane(socket);
  // Only the handshake and a subscription arrive here.
  socket.set(zmq::sockopt::maxmsgsize, std::int64_t{1024});
  const int on = 1;
  if (zmq_setsockopt(socket.handle(), ZMQ_XPUB_MANUAL, &on, sizeof on) != 0) throw zmq::error_t();
  if (zmq_setsockopt(socket.handle(), ZMQ_XPUB_NODROP, &on, sizeof on) != 0) throw zmq::error_t();
  be_curve_server(socket, keys, kLaneDomain);
  return socket;
}

zmq::socket_t make_lane_client(Context& context, const CurveKeys& keys, BytesView server_key, BytesView topic) {
  zmq::socket_t socket = make(context, zmq::socket_type::sub);
  be_lane(socket);
  socket.set(zmq::sockopt::reconnect_ivl, -1);
  socket.set(zmq::sockopt::connect_timeout, 1000);
  socket.set(zmq::sockopt::handshake_ivl, 2000);
  be_curve_client(socket, {keys, Bytes(server_key)});
  socket.set(zmq::sockopt::subscribe, Bytes(topic));
  return socket;
}

}  // namespace

Context::Context(int io_threads)
    : context_(at_start("a ZeroMQ context", [io_threads] { return make_context(io_threads); })) {}

Socket Socket::bus_client(Context& context, const std::string& endpoint, const CurveClient* curve) {
  return at_start(endpoint.empty() ? "the bus" : endpoint,
                  [&] { return Socket(make_bus_client(context, endpoint, curve)); });
}

Result<Socket> Socket::bus_server(Context& context, const std::string& endpoint, const CurveKeys* curve) {
  return or_error<Result<Socket>>(bound(endpoint), [&] {
    zmq::socket_t socket = make(context, zmq::socket_type::router);
    socket.set(zmq::sockopt::router_mandatory, true);
    be_bus_server(socket, endpoint, curve);
    return Socket(std::move(socket));
  });
}

Result<Socket> Socket::inbox(Context& context, const std::string& endpoint, const CurveKeys& keys) {
  return or_error<Result<Socket>>(bound(endpoint), [&] {
    zmq::socket_t socket = make(context, zmq::socket_type::router);
    socket.set(zmq::sockopt::router_mandatory, true);
    be_curve_server(socket, keys, kInboxDomain);
    socket.set(zmq::sockopt::rcvhwm, kLinkReceiveHighWaterMark);
    watch_connections(socket);
    if (!endpoint.empty()) socket.bind(endpoint);
    return Socket(std::move(socket));
  });
}

Result<Socket> Socket::dialler(Context& context, const CurveKeys& keys, BytesView server_key) {
  return or_error<Result<Socket>>("a socket to dial with",
                                  [&] { return Socket(make_dialler(context, keys, server_key)); });
}

Status Socket::bind(const std::string& endpoint) {
  unseen_->set(true);
  return or_error<Status>(bound(endpoint), [&] {
    socket_.bind(endpoint);
    return Done{};
  });
}

void Socket::unbind(const std::string& endpoint) {
  unseen_->set(true);
  // Only the name that zmq itself resolved counts; an interface that disappeared may have taken it along.
  zmq_unbind(socket_.handle(), endpoint.c_str());
}

Status Socket::dial(const std::string& endpoint) {
  unseen_->set(true);
  return or_error<Status>(endpoint, [&] {
    socket_.connect(endpoint);
    return Done{};
  });
}

Status Socket::dial_again(const std::string& endpoint) {
  zmq_disconnect(socket_.handle(), endpoint.c_str());  // libzmq may no longer know an endpoint that it has given up
  return dial(endpoint);
}

Result<Socket> Socket::tap_server(Context& context, const std::string& endpoint, const CurveKeys* curve) {
  return or_error<Result<Socket>>(bound(endpoint), [&] {
    zmq::socket_t socket = make(context, zmq::socket_type::xpub);
    // Each subscription is received, and so each subscriber known: a second one changes nothing for XPUB itself.
    const int on = 1;
    if (zmq_setsockopt(socket.handle(), ZMQ_XPUB_VERBOSER, &on, sizeof on) != 0) throw zmq::error_t();
    be_bus_server(socket, endpoint, curve);
    return Socket(std::move(socket));
  });
}

Socket Socket::tap_client(Context& context, const std::string& endpoint, const CurveClient* curve) {
  return at_start(endpoint, [&] { return Socket(make_tap_client(context, endpoint, curve)); });
}

Result<Socket> Socket::lane_server(Context& context, const CurveKeys& keys) {
  return or_error<Result<Socket>>("the own lane's socket", [&] { return Socket(make_lane_server(context, keys)); });
}

Result<Socket> Socket::lane_client(Context& context, const CurveKeys& keys, BytesView server_key, BytesView topic) {
  return or_error<Result<Socket>>("a lane's socket",
                                  [&] { return Socket(make_lane_client(context, keys, server_key, topic)); });
}

void Socket::let_listen(BytesView topic) {
  unseen_->set(true);
  const Bytes name(topic);
  zmq_setsockopt(socket_.handle(), ZMQ_SUBSCRIBE, name.data(), name.size());
}

Result<Socket> Socket::pair_client(Context& context, const std::string& endpoint) {
  return or_error<Result<Socket>>(endpoint, [&] {
    zmq::socket_t socket = make(context, zmq::socket_type::pair);
    socket.connect(endpoint);
    return Socket(std::move(socket));
  });
}

bool Socket::receive(Frame& frame) {
  const bool received = zmq_msg_recv(frame.handle(), socket_.handle(), ZMQ_DONTWAIT) >= 0;
  // EAGAIN: there is none. After any other error a message may still wait.
  unseen_->set(received || zmq_errno() != EAGAIN);
  return received;
}

std::uint64_t Socket::skip_rest(const Frame& last) {
  bool more = last.more();
  std::uint64_t bytes = 0;
  for (Frame frame; more && receive(frame); more = frame.more()) bytes += on_wire(frame.size());
  return bytes;
}

SendResult Socket::send(Frame&& frame, bool more) {
  const int flags = more ? ZMQ_DONTWAIT | ZMQ_SNDMORE : ZMQ_DONTWAIT;
  unseen_->set(true);
  // A refused message is still in `frame`.
  if (zmq_msg_send(frame.handle(), socket_.handle(), flags) >= 0) return SendResult::sent;
  if (zmq_errno() == EHOSTUNREACH) return SendResult::unroutable;
  // A socket checks only now and then whether its peer has made room. When asked for its events it checks at once.
  int events = 0;
  std::size_t size = sizeof events;
  zmq_getsockopt(socket_.handle(), ZMQ_EVENTS, &events, &size);
  if (zmq_msg_send(frame.handle(), socket_.handle(), flags) >= 0) return SendResult::sent;
  return zmq_errno() == EHOSTUNREACH ? SendResult::unroutable : SendResult::full;
}

bool Socket::has_room() {
  int events = 0;
  std::size_t size = sizeof events;
  zmq_getsockopt(socket_.handle(), ZMQ_EVENTS, &events, &size);
  unseen_->set((events & ZMQ_POLLIN) != 0);
  return (events & ZMQ_POLLOUT) != 0;
}

SendResult Socket::send_to(BytesView routing_id, Frame&& frame) {
  const SendResult addressed = send(to_frame(routing_id), true);
  return addressed == SendResult::sent ? send(std::move(frame)) : addressed;
}

Status Socket::monitor(const std::string& endpoint, int events) {
  if (zmq_socket_monitor(socket_.handle(), endpoint.c_str(), events) == 0) return Done{};
  return failed("a monitor", zmq::error_t());
}

int connection_fd(const Frame& frame) {
  return zmq_msg_get(frame.handle(), ZMQ_SRCFD);
}

int subscriber_fd(const Frame& frame) {
  const char* value = zmq_msg_gets(frame.handle(), "__fd");
  return value == nullptr ? -1 : std::atoi(value);
}

std::string_view user_id(const Frame& frame) {
  const char* value = zmq_msg_gets(frame.handle(), "User-Id");
  return value == nullptr ? std::string_view() : std::string_view(value);
}

}  // namespace trb
