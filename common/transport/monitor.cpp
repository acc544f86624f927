#include "common/transport/monitor.hpp"

#include <atomic>
#include <cstring>
#include <optional>
#include <stdexcept>
#include <utility>

namespace trb {
namespace {

constexpr int kEvents = ZMQ_EVENT_HANDSHAKE_SUCCEEDED | ZMQ_EVENT_HANDSHAKE_FAILED_NO_DETAIL |
                        ZMQ_EVENT_HANDSHAKE_FAILED_PROTOCOL | ZMQ_EVENT_HANDSHAKE_FAILED_AUTH | ZMQ_EVENT_DISCONNECTED |
                        ZMQ_EVENT_CLOSED | ZMQ_EVENT_CONNECT_RETRIED | ZMQ_EVENT_LISTENING | ZMQ_EVENT_ACCEPTED |
                        ZMQ_EVENT_ACCEPT_FAILED | ZMQ_EVENT_CONNECTED;
constexpr int kBatch = 256;

std::string make_endpoint() {
  static std::atomic<unsigned> count{0};
  return "inproc://monitor-" + std::to_string(++count);
}

Result<Socket> start_monitor(Context& context, Socket& socket, int events) {
  const std::string endpoint = make_endpoint();
  if (Status started = socket.monitor(endpoint, events); !started) return started.error();
  return Socket::pair_client(context, endpoint);
}

Socket started_monitor(Context& context, Socket& socket, int events) {
  auto pair = start_monitor(context, socket, events);
  if (!pair) throw std::runtime_error(pair.error().text());
  return std::move(*pair);
}

std::optional<LinkEvent> to_event(std::uint16_t event, std::uint32_t value) {
  switch (event) {
    case ZMQ_EVENT_HANDSHAKE_SUCCEEDED:
      return LinkEvent::connected;
    case ZMQ_EVENT_CONNECTED:
      return LinkEvent::reached;
    case ZMQ_EVENT_LISTENING:
      return LinkEvent::listening;
    case ZMQ_EVENT_ACCEPTED:
      return LinkEvent::accepted;
    case ZMQ_EVENT_ACCEPT_FAILED:
      return LinkEvent::accept_failed;
    case ZMQ_EVENT_DISCONNECTED:
      return LinkEvent::disconnected;
    case ZMQ_EVENT_CLOSED:
    case ZMQ_EVENT_CONNECT_RETRIED:
    case ZMQ_EVENT_HANDSHAKE_FAILED_NO_DETAIL:
      return LinkEvent::failed;
    case ZMQ_EVENT_HANDSHAKE_FAILED_AUTH:
      return LinkEvent::refused_key;
    case ZMQ_EVENT_HANDSHAKE_FAILED_PROTOCOL:
      if (value == ZMQ_PROTOCOL_ERROR_ZMTP_CRYPTOGRAPHIC) return LinkEvent::wrong_server_key;
      if (value == ZMQ_PROTOCOL_ERROR_ZMTP_MECHANISM_MISMATCH) return LinkEvent::no_curve;
      return LinkEvent::protocol_error;
    default:
      return std::nullopt;
  }
}

struct MonitorEvent {
  std::uint16_t event = 0;  ///< 0: not one of libzmq's
  std::uint32_t value = 0;
};

/// The next one, if there is one.
std::optional<MonitorEvent> receive_event(Socket& pair) {
  Frame frame;
  if (!pair.receive(frame)) return std::nullopt;
  MonitorEvent out;
  if (frame.size() < sizeof out.event + sizeof out.value) return out;
  std::memcpy(&out.event, frame.data(), sizeof out.event);
  std::memcpy(&out.value, static_cast<const char*>(frame.data()) + sizeof out.event, sizeof out.value);
  pair.skip_rest(frame);
  return out;
}

/// libzmq's thread waits for room for its next event, with a lock that the end of the monitor takes, too. It gets room
/// for more than comes until then.
void end_monitor(Socket& socket, Socket& pair) {
  while (receive_event(pair)) {
  }
  zmq_socket_monitor(socket.handle(), nullptr, 0);
}

}  // namespace

Result<std::unique_ptr<SocketMonitor>> SocketMonitor::watch(Context& context, Loop& loop, Socket& socket,
                                                            OnEvent on_event) {
  auto pair = start_monitor(context, socket, kEvents);
  if (!pair) return pair.error();
  return std::unique_ptr<SocketMonitor>(new SocketMonitor(loop, socket, std::move(*pair), std::move(on_event)));
}

SocketMonitor::SocketMonitor(Loop& loop, Socket& socket, Socket pair, OnEvent on_event)
    : loop_(loop), socket_(socket), pair_(std::move(pair)), on_event_(std::move(on_event)) {
  loop_.add_socket(
      pair_.handle(), [this] { serve(); }, pair_.unseen());
}

SocketMonitor::~SocketMonitor() {
  loop_.remove_socket(pair_.handle());
  end_monitor(socket_, pair_);
}

void SocketMonitor::serve() {
  // A handler may destroy this monitor.
  const std::weak_ptr<int> here = here_;
  for (int i = 0; i < kBatch && !here.expired() && serve_one(); ++i) {
  }
}

void SocketMonitor::catch_up() {
  const std::weak_ptr<int> here = here_;
  while (!here.expired() && serve_one()) {
  }
}

bool SocketMonitor::serve_one() {
  const auto came = receive_event(pair_);
  if (!came) return false;
  if (const auto known = to_event(came->event, came->value)) {
    const bool has_fd = came->event == ZMQ_EVENT_LISTENING || came->event == ZMQ_EVENT_ACCEPTED ||
                        came->event == ZMQ_EVENT_DISCONNECTED || came->event == ZMQ_EVENT_CONNECTED ||
                        came->event == ZMQ_EVENT_CLOSED;
    const auto handler = on_event_;
    handler(*known, has_fd ? static_cast<int>(came->value) : -1);
  }
  return true;
}

ConnectionWatch::ConnectionWatch(Context& context, Socket& socket)
    : socket_(socket),
      pair_(started_monitor(context, socket,
                            ZMQ_EVENT_CONNECTED | ZMQ_EVENT_HANDSHAKE_FAILED_AUTH | ZMQ_EVENT_DISCONNECTED)) {}

ConnectionWatch::~ConnectionWatch() {
  end_monitor(socket_, pair_);
}

bool ConnectionWatch::take_refused() {
  look();
  return std::exchange(refused_, false);
}

bool ConnectionWatch::take_ended() {
  look();
  return std::exchange(ended_, false);
}

bool ConnectionWatch::was_reached() {
  look();
  return reached_;
}

void ConnectionWatch::look() {
  while (const auto came = receive_event(pair_)) {
    const auto known = to_event(came->event, came->value);
    if (known == LinkEvent::reached) reached_ = true;
    if (known == LinkEvent::disconnected) ended_ = true;
    if (known == LinkEvent::refused_key) refused_ = true;
  }
}

}  // namespace trb
