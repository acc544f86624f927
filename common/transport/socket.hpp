// ZeroMQ sockets as this project uses them: never blocking, every refusal visible. None lingers when it is closed,
// except a dialled link, for 200 ms: its last message says why it ends. No exception of libzmq leaves this folder: what
// can fail while a program runs returns a Status or Result; what is created at startup throws std::runtime_error.
#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <string_view>
#include <zmq.hpp>

#include "common/base/bytes.hpp"
#include "common/base/result.hpp"
#include "common/transport/unseen.hpp"

namespace trb {

using Frame = zmq::message_t;

inline BytesView view_of(const Frame& frame) {
  return {static_cast<const char*>(frame.data()), frame.size()};
}
inline Frame to_frame(BytesView bytes) {
  return {bytes.data(), bytes.size()};
}

/// One context a process, with one I/O thread, or with two: the second then serves only the lossy lane.
class Context {
 public:
  explicit Context(int io_threads = 1);
  zmq::context_t& zmq() { return context_; }

 private:
  zmq::context_t context_;
};

struct CurveKeys {
  Bytes public_key;  ///< 32 bytes
  Bytes secret_key;
};

/// For a bus over TCP: the own keys, and the key that the router must have.
struct CurveClient {
  CurveKeys own;
  Bytes server_key;
};

/// The ZAP domains: which kind of socket a key is shown to.
constexpr std::string_view kInboxDomain = "talkrobots";
constexpr std::string_view kBusDomain = "talkrobots-bus";
constexpr std::string_view kLaneDomain = "talkrobots-lane";

enum class SendResult { sent, full, unroutable };

/// How many messages may wait for one receiver. A full queue refuses (queue_full), it never blocks. A ByteBudget limits
/// the bytes of large messages.
constexpr int kHighWaterMark = 1000;
constexpr int kBusHighWaterMark = 2 * kHighWaterMark;  ///< for a service: all peers' messages meet there
/// How many messages received on one connection may wait for the loop; more stay with their sender. libzmq counts no
/// bytes here, and a message has 1 MiB at most. On a bus the I/O thread is faster than the loop, which hashes: 128 MiB
/// for a service that floods. On links almost nothing waits while the loop runs, for the I/O thread decrypts what the
/// loop only hashes; 256, so that a burst costs no wake-ups. (With 64 a message of a burst cost a third more processor
/// time.)
constexpr int kReceiveHighWaterMark = 128;
constexpr int kLinkReceiveHighWaterMark = 256;
constexpr int kLaneHighWaterMark = 256;  ///< of the lossy lane, for each subscriber
constexpr int kLaneReceiveHighWaterMark = 64;
/// The messages and the bytes that a loop takes from one socket before the others have their turn.
constexpr int kTurnMessages = 256;
constexpr std::size_t kTurnBytes = 1U << 20U;

class Socket {
 public:
  /// A service's link to its router, or the router's end for that service (ipc://bus/NAME.ipc), or for all services
  /// (tcp://, with keys: bind ZAP first). With an empty endpoint nothing is connected until dial() or bind().
  static Socket bus_client(Context& context, const std::string& endpoint, const CurveClient* curve = nullptr);
  static Result<Socket> bus_server(Context& context, const std::string& endpoint, const CurveKeys* curve = nullptr);
  /// The one socket for other routers. ZAP must be bound before (zap.hpp). An empty endpoint leaves it closed until
  /// bind().
  static Result<Socket> inbox(Context& context, const std::string& endpoint, const CurveKeys& keys);
  /// Adds an endpoint. Errors: io_error naming it.
  Status bind(const std::string& endpoint);
  /// Stops listening there; connections stay. An endpoint that was not bound is ignored.
  void unbind(const std::string& endpoint);
  /// A dialled link: one connection, never made again by libzmq. Connect with dial() after the monitor is attached.
  /// Errors: io_error (no descriptor is left).
  static Result<Socket> dialler(Context& context, const CurveKeys& keys, BytesView server_key);
  /// Errors: io_error (not an endpoint, or no descriptor is left).
  Status dial(const std::string& endpoint);
  /// Dials anew: libzmq gives a connection up for good after receiving something malformed or too large.
  Status dial_again(const std::string& endpoint);
  /// The tap: XPUB, so that nothing is published while there is no subscriber.
  static Result<Socket> tap_server(Context& context, const std::string& endpoint, const CurveKeys* curve = nullptr);
  static Socket tap_client(Context& context, const std::string& endpoint, const CurveClient* curve = nullptr);
  /// The lossy lane: an XPUB that accepts no subscription by itself. It reports each one (a frame: 1 and the topic) and
  /// adds only what let_listen() allows to that connection. Sends are topic and frame; `full` if a subscriber to that
  /// topic has kLaneHighWaterMark messages waiting. In a context with two I/O threads it is on the second. bind()
  /// follows. Errors: io_error (no descriptor is left).
  static Result<Socket> lane_server(Context& context, const CurveKeys& keys);
  /// Subscribes to one topic at another node; one connection, never reopened by libzmq. dial() follows. Errors:
  /// io_error (no descriptor is left).
  static Result<Socket> lane_client(Context& context, const CurveKeys& keys, BytesView server_key, BytesView topic);
  void let_listen(BytesView topic);
  /// Receives a monitor's events. Errors: io_error.
  static Result<Socket> pair_client(Context& context, const std::string& endpoint);

  /// The next frame if there is one. For ROUTER sockets the first frame is the routing id.
  bool receive(Frame& frame);
  /// Drops the rest of a message of several frames. Returns how many bytes the dropped ones took on the wire.
  std::uint64_t skip_rest(const Frame& last);
  SendResult send(Frame&& frame, bool more = false);
  /// ROUTER: routing id and one frame. `unroutable`: that connection is gone.
  SendResult send_to(BytesView routing_id, Frame&& frame);

  /// Whether send() would take one more message. It looks for what came, too: see unseen().
  [[nodiscard]] bool has_room();

  [[nodiscard]] void* handle() { return socket_.handle(); }
  /// True while a message may wait that the socket's descriptor does not signal; for Loop::add_socket. Any operation on
  /// a socket may reset the descriptor's signal; only a receive() that found nothing makes it reliable again.
  [[nodiscard]] const std::shared_ptr<Unseen>& unseen() { return unseen_; }
  /// Reports its connections at an inproc endpoint. Errors: io_error (no descriptor is left).
  Status monitor(const std::string& endpoint, int events);
  [[nodiscard]] std::string last_endpoint() const { return socket_.get(zmq::sockopt::last_endpoint); }

 private:
  explicit Socket(zmq::socket_t socket) : socket_(std::move(socket)) {}
  zmq::socket_t socket_;
  std::shared_ptr<Unseen> unseen_ = std::make_shared<Unseen>();
};

/// The 32-byte CURVE key of the connection that a frame came on, as ZAP's User-Id gives it (hexadecimal); empty
/// without.
std::string_view user_id(const Frame& frame);
/// The descriptor of the connection that a frame came on, or -1; it may have been closed since.
int connection_fd(const Frame& frame);
/// The same for a frame that reports a subscription.
int subscriber_fd(const Frame& frame);

}  // namespace trb
