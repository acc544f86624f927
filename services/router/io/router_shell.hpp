// The router's sockets around its core: the bus, the inbox, the dialled links, the beacon, the tap.
#pragma once

#include <deque>
#include <map>
#include <memory>
#include <string>

#include "common/config/interfaces.hpp"
#include "common/log/log.hpp"
#include "common/security/beacon_key.hpp"
#include "common/transport/byte_budget.hpp"
#include "common/transport/loop.hpp"
#include "common/transport/monitor.hpp"
#include "common/transport/signals.hpp"
#include "common/transport/socket.hpp"
#include "common/transport/zap.hpp"
#include "services/router/core/router_core.hpp"
#include "services/router/io/beacon_socket.hpp"
#include "services/router/io/inbox_guard.hpp"
#include "services/router/io/interface_watch.hpp"
#include "services/router/io/keys_watch.hpp"

namespace trb::router {

class LaneServer;
class ProofLog;
class Resolver;
class SealChecker;

/// A bus over TCP; without an address it is sockets in the node's folder.
struct TcpBus {
  std::string endpoint;  ///< of messages, for libzmq
  std::string tap;
  CurveKeys keys;
  std::map<Bytes, std::string, std::less<>> names;  ///< public key -> the service that it proves, or "probe"
};

struct ShellOptions {
  CurveKeys link_keys;
  std::string host_int;  ///< an interface or an address: the inbox and the beacons
  std::string vpn_int;   ///< a second way in, when it is there; may be empty
  std::uint16_t port = 0;
  std::uint16_t lane_port = 0;  ///< 0: any
  std::uint16_t beacon_port = 0;
  BeaconKey beacon_key;
  PendingConnectionLimits pending_connections;
  std::uint64_t proof_log_bytes = 0;  ///< at most so much in log/proof; 0: no proof log
  TcpBus bus;
};

constexpr const char* kBootFile = "state/boot";
/// Errors: io_error, with what to do.
Status write_boot(std::uint64_t boot);

/// How a dialled connection has ended, if that is what the event tells.
std::optional<LinkEnd> to_end(LinkEvent event);

/// Why a service of this node did not get a message.
constexpr Errc why_undelivered(SendResult result) {
  return result == SendResult::full ? Errc::queue_full : Errc::no_service;
}

/// Why a link did not take a message.
constexpr Errc why_unsent(SendResult result) {
  return result == SendResult::full ? Errc::queue_full : Errc::peer_unreachable;
}

class RouterShell {
 public:
  RouterShell(RouterConfig config, ShellOptions options);
  ~RouterShell();

  /// Binds everything that is there; an interface that is not is waited for. Errors: io_error naming the address.
  Status open();
  /// Runs until SIGTERM or SIGINT (0) or SIGHUP (75: to be started again).
  int run();

 private:
  struct BusSocket {
    Socket socket;
    std::string name;  ///< whom it proves; empty: the key does
    std::map<Bytes, ConnectionId, std::less<>> connections;
  };
  struct BusConnection {
    BusSocket* socket = nullptr;
    Bytes routing_id;
    std::string name;  ///< whom it proves
    std::shared_ptr<ByteBudget> budget;
  };
  struct Dialled {
    std::shared_ptr<ByteBudget> budget;
    std::unique_ptr<Socket> socket;
    std::unique_ptr<SocketMonitor> monitor;
    std::string name;  ///< of a seed that was resolved
  };
  struct Accepted {
    Bytes routing_id;
    Bytes user;  ///< User-Id: the key, in hexadecimal
    PendingConnectionId pending = 0;
    std::shared_ptr<ByteBudget> budget;
  };
  /// Where the message now being handled came from, for AcceptLink and RefuseCandidate.
  struct InboxOrigin {
    Bytes routing_id;
    Bytes user;
    PendingConnectionId pending = 0;
  };

  Status open_bus();
  // bus_side.cpp
  void drain_bus(BusSocket& bus);
  /// How many it counts for in this turn.
  int on_bus_frame(BusSocket& bus, BytesView routing_id, Frame& frame);
  void forward_bus_frame(ConnectionId from, const HeaderView& header, Frame& frame);
  void send_forwarded(ConnectionId from, const HeaderView& header, const FrameOrders& orders, Frame& frame,
                      Effects& effects);
  void send_copy(const Routing& way, const Frame& frame);
  ConnectionId connection_of(const BusSocket& bus, BytesView routing_id) const;  ///< 0: none
  ConnectionId add_connection(BusSocket& bus, BytesView routing_id, const std::string& name);
  void on_bus_hello(BusSocket& bus, ConnectionId from, const std::string& name, const HeaderView& header);
  void free_dead_holder(const ServiceHello& hello, Effects& effects);
  void free_dead_probes(BusSocket& bus, ConnectionId asker, Effects& effects);
  bool is_gone(ConnectionId connection);
  void want_hello(BusSocket& bus, BytesView routing_id);
  void forget_unknown();
  void forget_connection(ConnectionId connection, Effects& effects);
  SendResult send_bus(ConnectionId to, Frame&& frame);
  // tcp_bus.cpp
  Status open_tcp_bus();
  bool admit_to_bus(BytesView key);
  [[nodiscard]] std::string whom_it_proves(const BusSocket& bus, const Frame& frame) const;  ///< empty: nobody
  void note_pending_on_bus(const BusSocket& bus, const Frame& frame, ConnectionId from);
  PendingConnectionId pending_at_inbox(const Frame& frame);
  void on_bus_event(LinkEvent event, int fd, bool proves);
  // lane_side.cpp
  [[nodiscard]] std::string own_lane() const;
  void open_lane();
  void publish(LinkId link, Frame&& frame);
  void dial_lane(const DialLane& effect);
  Status open_lane(const DialLane& effect, SocketMonitor::OnEvent on_event);
  void close_heard(LinkId link);
  void drain_lane(LinkId link);
  void on_lane_frame(LinkId link, Frame& frame);
  // link_side.cpp
  void drain_inbox();
  void on_inbox_frame(BytesView routing_id, Frame& frame);
  void on_other_version(BytesView routing_id, Frame& frame);
  void drain_dialled(LinkId link);
  void on_undecoded(LinkId link, const Frame& frame, const Error& error);
  void on_link_frame(LinkId link, const HeaderView& header, Frame& frame);
  void deliver_frame(LinkId link, const HeaderView& header, Frame& frame, const FrameOrders& orders, Effects& effects);
  void dial(const Dial& effect);
  void dial_numbers(const Dial& effect, const std::string& name);
  Status open_dialled(const Dial& effect, const std::string& name);
  void close_link(LinkId link);
  [[nodiscard]] bool link_has_room(LinkId link, std::size_t bytes) const;
  SendResult send_link(LinkId link, Frame&& frame);
  SendResult put_on_link(LinkId link, Frame&& frame);
  /// A frame that is numbered, with its seals.
  SendResult put_outgoing(LinkId link, const Outgoing& outgoing, Frame&& frame);
  void on_inbox_event(LinkEvent event, int fd);
  void on_bad_frame(LinkId link, const Error& error);
  [[nodiscard]] std::vector<std::string> sources_of_peers() const;
  void on_source_blocked(const std::string& source);
  void on_pending_cut(const std::string& address);
  // local_address.cpp
  Status open_local_address();
  Status open_inbox(const Resolved& host);
  void follow_interfaces();
  void move_to(const Resolved& host);
  void notify_local_address();
  void follow_vpn();
  [[nodiscard]] std::string own_address() const;
  [[nodiscard]] std::string to_dial(const std::string& address) const;
  // trust_side.cpp
  void store_news(const StoreNews& store);
  void store_certificate(const StoreCertificate& store);
  void store_boot(const StoreBoot& store);
  void store_utc(const StoreUtc& store);
  void stored(Kept what, const Status& done);
  void read_key_folder();  ///< a person may have put a new certificate.json or news.json there
  // seal_side.cpp
  void send_seal(LinkId link);
  SendResult put_seal(LinkId link, BytesView seal);
  void keep_proof(const FrameOrders& orders, UtcTime now, BytesView frame);
  void report_proof_log();
  void check_seal(CheckSeal&& seal);
  void take_checked();
  SendResult deliver(LinkId link, std::uint64_t sequence, bool hold, ConnectionId to, Frame&& frame);
  void deliver_held(const DeliverHeld& proven);
  void return_held(const ReturnHeld& of);
  // router_shell.cpp
  void carry_out(Effects& effects);
  void report_unsent();
  [[nodiscard]] RouterConfig with_ports(RouterConfig config) const;
  void end_lost_links();
  [[nodiscard]] std::shared_ptr<ByteBudget> new_budget() const;
  void send_own(LinkSend& send);
  std::optional<Bytes> own_frame(const Message& message);
  void tap(char direction, BytesView frame);
  void drain_tap();
  void count_sent(std::string_view subtype);
  void on_beacon_datagram(BytesView datagram);

  RouterCore core_;
  ShellOptions options_;
  Context context_{2};
  Loop loop_;
  std::shared_ptr<ByteBudget> whole_;       ///< of what waits in all queues
  std::shared_ptr<ByteBudget> tap_budget_;  ///< of all who listen to the tap: they share each message
  std::unique_ptr<ZapServer> zap_;
  std::map<std::string, std::unique_ptr<BusSocket>> buses_;
  std::map<ConnectionId, BusConnection> connections_;
  ConnectionId next_connection_ = 0;
  std::unique_ptr<Socket> inbox_;
  std::unique_ptr<SocketMonitor> inbox_monitor_;
  InboxGuard inbox_guard_{loop_, options_.pending_connections,
                          [this](const std::string& source) { on_source_blocked(source); },
                          [this](const std::string& address) { on_pending_cut(address); }};
  std::unique_ptr<LaneServer> lane_;
  std::map<LinkId, Dialled> dialled_;
  std::map<LinkId, Dialled> heard_;  ///< the lanes of the peers
  std::vector<Dialled> closed_;      ///< freed between turns: a monitor must not die inside its own call
  std::map<LinkId, Accepted> accepted_;
  struct Held {
    std::uint64_t sequence = 0;
    ConnectionId to = 0;
    Frame frame;
  };
  std::map<LinkId, std::deque<Held>> held_;  ///< until their seal is checked; kMaxUnsealed and kMaxHeldBytes at most
  std::unique_ptr<ProofLog> proof_;
  std::unique_ptr<SealChecker> checker_;
  std::unique_ptr<Resolver> resolver_;
  InboxOrigin origin_;
  std::vector<LinkId> lost_links_;
  std::vector<std::pair<Message, Errc>> unsent_;  ///< of the router itself, that did not leave
  std::unique_ptr<InboxGuard> bus_door_;          ///< of a bus over TCP
  std::unique_ptr<Socket> tap_;
  std::vector<std::unique_ptr<SocketMonitor>> bus_monitors_;  ///< of the bus, and of the tap
  unsigned tap_listeners_ = 0;
  std::unique_ptr<BeaconSocket> beacon_;
  std::unique_ptr<InterfaceWatch> interface_watch_;
  Resolved host_;             ///< where the inbox is; without an address while it is nowhere
  std::string wait_text_;     ///< why it is nowhere
  std::string vpn_endpoint_;  ///< the inbox's second one, while it is bound
  std::optional<MonotonicTime> look_again_;
  MonotonicTime alone_until_;
  std::unique_ptr<KeysWatch> keys_watch_;
  RateLimit limit_{20, std::chrono::seconds(10)};
  std::map<std::string, std::string, std::less<>> sent_names_;  ///< subtype -> "sent.SUBTYPE", made once
};

}  // namespace trb::router
