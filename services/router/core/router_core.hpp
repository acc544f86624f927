// The router's state machine: registration, routing table, leases, local delivery. Message or time in, effects out.
#pragma once

#include <map>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "proto/body.hpp"
#include "services/router/core/budget.hpp"
#include "services/router/core/clock_bound.hpp"
#include "services/router/core/config.hpp"
#include "services/router/core/news.hpp"
#include "services/router/core/peers.hpp"
#include "services/router/core/seals.hpp"
#include "services/router/core/services.hpp"
#include "services/router/core/troubles.hpp"
#include "services/router/core/unstored.hpp"

namespace trb::router {

/// How a dialled link ended.
enum class LinkEnd : unsigned char { failed, disconnected, refused_key, no_curve, wrong_server_key, protocol_error };
constexpr auto enum_names(LinkEnd) {
  return std::array<std::string_view, 6>{"failed",   "disconnected",     "refused_key",
                                         "no_curve", "wrong_server_key", "protocol_error"};
}

class RouterCore {
 public:
  explicit RouterCore(RouterConfig config);

  void start(Now now, Effects& out);
  /// The inbox's address is another one now: what was linked over the old one is dialled again. Empty while the node
  /// has none; then `why` says what it waits for.
  void set_address(const std::string& address, const std::string& why, Now now, Effects& out);
  void tick(Now now, Effects& out);
  [[nodiscard]] std::optional<MonotonicTime> next_deadline() const;

  // ---- the road of a message: decided on its header alone, nothing is copied

  /// A message of a service or probe. Refused (drop) with a reason; the caller Nacks.
  Routing route_local(ConnectionId from, const HeaderView& header);
  /// A message that came by a link; that it came on that link's own connection is proven by the shell (socket, or
  /// routing id and User-Id). The sequence and the source are checked here.
  Routing route_peer(LinkId link, const HeaderView& header, Now now, Effects& out);
  /// Numbers a frame that is about to leave by a link and takes it into the link's running hash. False: no such link.
  /// take_back() if it did not leave.
  bool stamp(LinkId link, char* frame, std::size_t size);
  void take_back(LinkId link);
  [[nodiscard]] std::vector<LinkId> up_links() const;
  /// Peers that are reached by a relay alone.
  [[nodiscard]] std::vector<std::string> relayed_peers() const;
  /// A frame of the bus, locked for its target, signed, and addressed to the relay that reaches it. If who sent it
  /// waits for an answer, it is told when nobody confirms that it came. Errors: too_large (over 511 kB), queue_full
  /// (256 unconfirmed), peer_unreachable.
  Result<Relaying> relay_out(ConnectionId from, std::string_view target, const HeaderView& header, BytesView frame,
                             Now now);
  /// The answer to a message that could not be delivered.
  void nack_local(ConnectionId from, const HeaderView& header, Errc reason, Effects& out);
  void nack_peer(LinkId from, const HeaderView& header, Errc reason, Effects& out);
  /// The same of one that came by a link which ends before its seal came: counted, and the Nack, if it deserves one.
  std::optional<Message> nack_unsealed(const HeaderView& header, Effects& out) {
    return nack_relayed(header, Errc::seal_broken, out);
  }

  /// A `relayed` could not leave by a link: its signer, this node or another, is told.
  void not_passed_on(const Message& message, Errc reason, Effects& out);

  // ---- the node's own bus

  /// `proven` is whom the connection's socket or key proves: a service, or kProbe.
  void on_service_hello(ConnectionId from, const ServiceHello& hello, std::string_view proven, Now now, Effects& out);
  void on_connection_gone(ConnectionId connection, Now now, Effects& out);
  [[nodiscard]] std::optional<ConnectionId> holder_of(std::string_view service) const {
    return services_.holder(service);
  }
  [[nodiscard]] bool bus_is_full() const { return services_.all().size() >= kMaxConnections; }
  [[nodiscard]] bool knows(ConnectionId connection) const { return services_.find(connection) != nullptr; }
  /// A message for the router itself, from the bus.
  void on_bus_message(ConnectionId from, const Message& message, Now now, Effects& out);

  // ---- links

  /// ZAP: may this key connect? Members may; of strangers 32 at a time, for 2 s.
  bool admit(BytesView key, MonotonicTime now, Effects& out);
  void on_dial_connected(LinkId link, Now now, Effects& out);
  void on_link_ended(LinkId link, LinkEnd how, Now now, Effects& out);
  /// A seed's host name was found: what is dialled for this link is this, in numbers.
  void on_name_found(LinkId link, const std::string& address);
  /// It is not known, or not yet: the dial ends as one that failed. `why` is for people; empty: nothing to tell yet.
  void on_name_unknown(LinkId link, const std::string& why, Now now, Effects& out);
  /// A message for the router itself, or the first one (Hello), that came by a link.
  void on_link_message(LinkId link, BytesView key, const Message& message, std::uint64_t sequence, Now now,
                       Effects& out);
  /// A frame that is none came by this link, or by a connection without one (0): the next of the link would be missing.
  void on_bad_frame(LinkId link, const Error& error, Now now, Effects& out);
  /// What came by a connection, or by this dialled link, is of another version of the wire: its node is refused by
  /// name, and told why in the version that it reads.
  void on_other_version(LinkId link, BytesView key, std::uint8_t version, const HeaderView& header, Now now,
                        Effects& out);
  /// A connection that carries this link names another one: one connection is one link. It is over.
  void on_second_link(LinkId link, Now now, Effects& out);
  void on_beacon(BytesView plain, Now now, Effects& out);

  // ---- the lossy lane: where this node is heard, and hears others, of what may be lost

  /// Where this node's can be dialled; empty: nowhere.
  void set_lane(const std::string& address) { config_.lane = address; }
  /// How lossy information leaves for a peer: by the lane if it listens there; else as other messages do, while that is
  /// little; else it is dropped and counted.
  Routing by_lane(std::string_view to, std::size_t size, Now now);
  /// ZAP: only peers with a link that is up may listen.
  bool admit_to_lane(BytesView key, Effects& out);
  /// A connection of this key wants to hear `topic`. Its link; nothing: refused, and to be cut.
  std::optional<LinkId> on_listen(BytesView key, BytesView topic, Effects& out);
  void on_listener_gone(LinkId link);
  /// It said something that is no subscription.
  void bar_from_lane(BytesView key, Effects& out);
  void on_lane_connected(LinkId link, Now now);
  void on_lane_ended(LinkId link, LinkEnd how, Now now, Effects& out);
  /// What came by the lane that was dialled for this link: only to a service, or dropped and counted here.
  Routing route_lane(LinkId link, const HeaderView& header, Effects& out) const;

  // ---- seals

  /// Every frame that came by a link that is up, its Hello included: before it is handled, or after if that brought the
  /// link up.
  void hear_frame(LinkId link, const HeaderView& header, BytesView frame, Now now, Effects& out);
  /// A seal must leave before the next message.
  [[nodiscard]] bool seal_is_overdue(LinkId link) const;
  /// Each message is sealed by itself, at once.
  [[nodiscard]] bool seals_each(LinkId link) const;
  /// The frame of a seal over what is unsealed, if anything is; seal_left() once it has left, before the next frame.
  std::optional<Bytes> make_seal(LinkId link, Now now);
  void seal_left(LinkId link);
  /// What comes by this link is delivered only when it is proven (DeliverHeld).
  void on_seal_checked(const CheckSeal& seal, bool good, Now now, Effects& out);
  [[nodiscard]] bool holds(LinkId link) const;
  [[nodiscard]] const LinkSeals* seals_of(LinkId link) const;
  /// CloseLink was carried out: nothing leaves by it any more.
  void forget_link(LinkId link);
  /// A datagram on the beacons' port that did not open.
  void on_bad_beacon(const Error& why, Now now, Effects& out) {
    refuse_beacon(errc_name(why.code), why.what, now, out);
  }

  /// What the authority has signed, from any road: a link, the bus, a file (0). What is new is stored, done at once and
  /// told to the others. Returns it in words. Errors: bad_signature, foreign_fleet, downgraded, conflict, malformed,
  /// cert_revoked, cert_expired, cert_not_yet_valid.
  Result<std::string> on_news(const FleetNews& news, LinkId from, Now now, Effects& out);

  /// The shell has stored what an effect told it to, or could not: then what it is stays in force, is told to people
  /// and tried again.
  void on_stored(Kept what, const Status& done, Now now, Effects& out);

  /// The same of a file on this node; refusals are counted and logged.
  void on_news_of_file(const FleetNews& news, Now now, Effects& out);

  /// A page of the table: this node first, then the peers whose ids come behind `after`.
  [[nodiscard]] RouteTable route_table(Now now, const std::string& after = {}) const;
  [[nodiscard]] const std::map<std::string, Peer, std::less<>>& peers() const { return peers_; }
  [[nodiscard]] const Link* find_link(LinkId id) const;
  [[nodiscard]] const RouterConfig& config() const { return config_; }
  [[nodiscard]] std::uint64_t counter(std::string_view name) const;
  /// Writes down for `trb doctor` what the shell saw go wrong with a link; 0 for one that is none of ours.
  void note_trouble(LinkId link, std::string_view code, std::string_view text, Now now);
  /// Raises a counter; the shell calls it for Effects::counts.
  void count(std::string_view name, std::uint64_t by = 1);

  /// The node's services that want a copy of it, besides the one that takes it. A link's waits for its seal as the
  /// message does.
  [[nodiscard]] std::vector<ConnectionId> hearers_of(const HeaderView& header) const;

 private:
  // road.cpp
  [[nodiscard]] Routing route_relayed(const HeaderView& header, const Certificate& source, Effects& out) const;
  std::optional<Message> nack_relayed(const HeaderView& header, Errc reason, Effects& out);
  [[nodiscard]] Routing route_to_self(const HeaderView& header, Party from) const;
  [[nodiscard]] Routing route_from(const Peer& peer, const HeaderView& header, Effects& out) const;
  [[nodiscard]] const Connection* asker_of(std::uint64_t reply_to) const;
  void note_asked(ConnectionId from, const HeaderView& header, Party whom);
  [[nodiscard]] Message make_nack(const HeaderView& header, Errc reason) const;

  // bus.cpp
  std::optional<Message> make_own(const std::string& target, std::uint64_t reply_to, const Body& body, Effects& out);
  void bus_send(ConnectionId to, std::uint64_t reply_to, const Body& body, Effects& out);
  [[nodiscard]] Status may_be(const ServiceHello& hello, std::string_view proven) const;
  void answer(ConnectionId to, const Message& asked, const Body& body, Effects& out);
  void deny(ConnectionId to, const Message& asked, const Error& error, Effects& out);
  void sign_for(ConnectionId from, const Message& message, const SignRequest& request, Effects& out);
  void forget_silent_probes(Now now, Effects& out);
  Status may_sign_for(const Connection& from, const SignRequest& request) const;
  [[nodiscard]] ServiceTable service_table(Now now) const;
  [[nodiscard]] Counters counters() const;
  Result<Body> answer_to(const Message& message, Now now) const;
  Result<Body> answer_peer(Peer& peer, const Message& message, Now now) const;
  void tell_services(Body body, Effects& out);

  // sensors.cpp
  [[nodiscard]] bool is_plugged(std::string_view sensor) const;
  void on_node_sensors(const NodeSensors& told, Effects& out);
  void on_robot_profile(const NodeProfile& told, Now now, Effects& out);
  void profile_refused(std::size_t size, Now now, Effects& out);
  bool make_fit(NodeProfile& profile) const;
  void tell_own_profile(Effects& out);
  void sensor_bus_gone(const Connection& connection, Now now);
  [[nodiscard]] std::optional<MonotonicTime> sensors_end() const;
  void tick_sensors(Now now, Effects& out);

  // links.cpp, hello.cpp
  void dial(Redial& redial, const std::string& address, BytesView key, Now now, Effects& out);
  void send_hello(Link& link, Now now, Effects& out);
  void on_early_message(LinkId id, BytesView key, const Message& message, Now now, Effects& out);
  void on_peer_message(Link& link, const Message& message, Now now, Effects& out);
  [[nodiscard]] static Result<Hello> read_hello(LinkId id, const Message& message);
  void on_hello(LinkId id, BytesView key, const Message& message, std::uint64_t sequence, Now now, Effects& out);
  bool may_say_hello(LinkId id, BytesView key, Now now, Effects& out);
  Result<Certificate> check_hello(const Link& link, const Message& message, const Hello& hello, Now now, Effects& out);
  /// Whether a Hello that is refused is at least of the node that it names, whatever else is wrong with it.
  [[nodiscard]] bool proves_name(const Link& link, const Message& message, const Hello& hello) const;
  void link_up(Link& link, const Certificate& certificate, const Hello& hello, Now now, Effects& out);
  void carry_by(Link& link, const Hello& hello, Now now, Effects& out);
  bool settle_double(Link& link, Peer& peer, Now now, Effects& out);
  void drop_link(LinkId id, const std::string& why, bool say_goodbye, Now now, Effects& out);
  void tell_candidate(LinkId id, const Body& body, Effects& out, std::uint8_t version = kWireVersion);
  void hand_news(LinkId id, bool dialled, const std::string& to, const Error& refusal, const Hello& hello,
                 Effects& out);
  void refuse_candidate(LinkId id, BytesView key, const Error& error, Now now, Effects& out);
  void link_send(Link& link, const Body& body, Effects& out, const Message* asked = nullptr);
  void deny_peer(Link& link, const Message& message, const Error& error, Effects& out);
  void on_keep_alive(Link& link, const KeepAlive& body, Now now);
  void redial_later(Redial& redial, Now now, Duration at_least = {});
  void redial_failed(LinkId id, Now now);
  void tell_profile(Link& link, Effects& out);
  [[nodiscard]] bool dialling(BytesView key) const;
  Peer& make_peer(const Certificate& certificate, const SignedRecord& record);

  // lane.cpp
  void find_lane(Link& link, const Hello& hello, Now now);
  void tick_lanes(Now now, Effects& out);
  Link* linked_by_key(BytesView key);

  [[nodiscard]] Route route_of(const Peer& peer, Now now) const;

  // relay.cpp
  void neighbour_changed(const std::string& id, Now now);
  [[nodiscard]] bool relays() const { return config_.relay && config_.own.relay; }
  void tell_neighbours(Link& to, const std::set<std::string>& about, Effects& out);
  void tell_all_neighbours(Link& to, Effects& out);
  void tick_relay(Now now, Effects& out);
  /// The relay that would be given what is for the peer, or nullptr: whether or not the road by it is open.
  [[nodiscard]] const Link* carrier_of(const Peer& peer) const;
  /// The relay by which the peer is reached now, or nullptr.
  [[nodiscard]] const Link* relay_of(const Peer& peer) const;
  void change_carrier(Peer& peer);
  void on_neighbours(Link& link, const Neighbours& told, Now now, Effects& out);
  void learn_neighbour(Link& link, const SignedRecord& told, Now now, Effects& out);
  static void refuse_neighbour(const Link& relay, const Error& error, Effects& out);
  void forget_relay(Peer& peer, const std::string& relay, Effects& out);
  void relay_lost(const Link& relay, Effects& out);
  static void send_on(Link& link, Message message, Effects& out);
  static void refuse_relayed(const Link& link, std::string_view reason, const std::string& text, Effects& out);
  void on_relayed(Link& link, const Message& message, const Relayed& body, Now now, Effects& out);
  void pass_on(Link& link, const Message& message, const Relayed& body, const RelayedFrame& inner, Effects& out);
  [[nodiscard]] std::optional<std::pair<std::string_view, std::string>> check_relayed(const Peer& source,
                                                                                      const SignedRecord& record,
                                                                                      const RelayedFrame& inner,
                                                                                      Now now) const;

  // relayed.cpp
  [[nodiscard]] UtcTime utc_by(const Link& relay, Now now) const;
  Message wrap(Peer& peer, const Link& relay, std::uint64_t target_boot, std::uint64_t count, BytesView frame,
               std::uint32_t remaining_ms, Now now);
  void not_relayed(std::string_view target, std::uint64_t count, Errc reason, Effects& out);
  void on_relay_refused(const Link& link, const RelayRefused& told, Effects& out);
  void tell_lost(const Unconfirmed& question, Errc reason, Effects& out);
  void tell_lost(const std::vector<Unconfirmed>& questions, Effects& out);
  void send_relayed(const std::string& to, const Message& message, Now now, Effects& out);
  void say_alive(Peer& peer, Now now, Effects& out);
  void tick_roads(Now now, Effects& out);
  void leave_road(Peer& peer, const std::string& why, Effects& out);
  void on_relay_alive(const Link& link, Peer& peer, const RelayedFrame& inner, const HeaderView& header, Now now,
                      Effects& out);
  void join_by_relay(Peer& peer, const Link& relay, Now now, Effects& out);
  [[nodiscard]] std::optional<MonotonicTime> profile_due(const Peer& peer) const;
  void tell_profile_by_relay(Peer& peer, Now now, Effects& out);
  void take_profile(Peer& peer, BytesView data, Now now, Effects& out);
  void take_relayed(Peer& source, const HeaderView& header, Now now, Effects& out);
  void answer_relayed(const std::string& to, const Message& asked, Now now, Effects& out);

  // moves.cpp
  void tick_known(Now now, Effects& out);
  [[nodiscard]] bool is_expected(BytesView key) const;
  static const std::string& address_to_dial(Peer& peer);
  void set_peer_address(Peer& peer, const std::string& address, Now now, Effects& out);

  // troubles.cpp
  void note_up(const Link& link, const Hello& hello, Now now);

  // news.cpp
  [[nodiscard]] bool is_known_certificate(const SignedRecord& record) const;
  Status take_list(const SignedRecord& record, Now now, Effects& out);
  Status take_certificate(const SignedRecord& record, Now now, Effects& out);
  void take_own_certificate(const SignedRecord& record, const Certificate& certificate, Effects& out);
  [[nodiscard]] FleetNews known_news() const;
  void store_news(Effects& out);
  void answer_news(ConnectionId from, const Message& message, const FleetNews& news, Now now, Effects& out);
  void tick_unstored(Now now, Effects& out);
  std::size_t flood_news(const FleetNews& fresh, LinkId from, Effects& out);
  void tell_news(Link& link, std::uint64_t known_list, Now now, Effects& out);
  void send_news(Link& link, const FleetNews& news, Effects& out);
  void forget_ended_renewals(Now now);
  [[nodiscard]] bool has_ended(const SignedRecord& renewal, Now now) const;
  void forget_told_renewal(const Certificate& certificate);
  void on_news_message(const Link& link, const Message& message, Now now, Effects& out);
  /// What a refused node has to know to come back: its renewed certificate, or the list that it is on.
  [[nodiscard]] std::optional<FleetNews> news_for(const Error& refusal, const Hello& hello) const;

  // membership.cpp
  [[nodiscard]] Result<Certificate> open_known(const SignedRecord& record) const;
  Result<Certificate> open_member(const SignedRecord& record, Now now, Effects& out);
  [[nodiscard]] Status check_newest(const Certificate& certificate) const;
  void apply_revocations(Now now, Effects& out);
  void put_out(const std::string& id, Now now, Effects& out);
  void remember_revoked(const Certificate& certificate);
  bool refuse_revoked_key(BytesView key, MonotonicTime now, Effects& out);
  void check_own(Now now, Effects& out);
  void mute(const std::string& why, Now now, Effects& out);
  [[nodiscard]] std::string own_trouble(Now now) const;
  [[nodiscard]] std::string own_note(Now now) const;
  void warn_of_end(Now now, Effects& out);
  void raise_utc_bound(UtcTime utc, Effects& out);
  void note_time(Now now, Effects& out);
  // seals.cpp
  void open_seals(const Link& link);
  void bind_seals(const Link& link, const Certificate& certificate, const Hello& hello);
  [[nodiscard]] std::optional<MonotonicTime> next_seal() const;
  void seal_now(LinkId link, Effects& out) const;
  void last_seal(LinkId link, Effects& out);
  void tick_seals(Now now, Effects& out);
  void on_seal(const Link& link, const Seal& seal, Now now, Effects& out);
  void seal_broken(LinkId id, const std::string& peer, SealFault fault, Now now, Effects& out);
  void tell_unsealed(LinkId link, const std::string& peer, Effects& out);

  // leases.cpp
  void tick_links(Now now, Effects& out);
  void tick_peers(Now now, Effects& out);
  void tick_seeds(Now now, Effects& out);
  void tick_beacon(Now now, Effects& out);
  void tick_candidates(Now now, Effects& out);
  [[nodiscard]] bool tells_nothing(const std::string& signer, const Beacon& beacon, Now now) const;
  void refuse_beacon(std::string_view reason, const std::string& text, Now now, Effects& out);
  void expire(Peer& peer, const std::string& reason, Effects& out);
  [[nodiscard]] bool own_is_smaller(std::string_view other) const { return config_.id < other; }
  [[nodiscard]] UtcTime checked_utc(UtcTime utc) const;

  RouterConfig config_;
  Services services_;
  NodeProfile profile_;                        ///< what the fleet is told
  NodeProfile robot_profile_;                  ///< of it, what the mode-adapter said
  std::vector<SensorInfo> plugged_;            ///< of it, what the sensor-bus said
  std::optional<MonotonicTime> sensors_lost_;  ///< until when a sensor-bus that is gone may come back
  std::uint64_t profile_number_ = 1;           ///< rises with each change
  std::map<std::string, Peer, std::less<>> peers_;
  std::map<Bytes, std::string, std::less<>> peers_by_key_;
  std::map<LinkId, Link> links_;
  std::vector<Seed> seeds_;
  std::map<Bytes, MonotonicTime, std::less<>> candidates_;  ///< key -> until when a Hello must have come
  std::map<Bytes, MonotonicTime, std::less<>> denied_;      ///< key -> until when it stays out
  std::map<Bytes, MonotonicTime, std::less<>> noisy_;       ///< members' keys -> until when they stay out
  std::string waits_for_;                                   ///< why this node has no address; empty if it has one
  std::optional<MonotonicTime> next_store_;
  MonotonicTime started_{};
  std::set<std::string> changed_neighbours_;  ///< of which the peers have not been told yet
  std::optional<MonotonicTime> next_neighbours_;
  std::optional<MonotonicTime> next_beacon_;
  MonotonicTime last_beacon_;
  std::uint32_t early_beacons_ = 3;  ///< a burst at the start
  std::uint64_t beacon_count_ = 0;
  Budget beacon_budget_{kBeaconsChecked};
  std::map<std::string, std::uint64_t, std::less<>> counts_;
  std::uint64_t message_count_ = 0;
  std::uint64_t peer_count_ = 0;  ///< that there ever were
  Troubles troubles_;
  NewsState news_;
  /// Who has brought news, and what it is told once that is on disk.
  struct Asker {
    ConnectionId from = 0;
    Message message;  ///< without its data
    std::string text;
  };
  Unstored unstored_;
  std::vector<Asker> askers_;
  ClockBound clock_;
  std::optional<MonotonicTime> next_own_check_;  ///< while the own certificate does not count
  std::map<LinkId, LinkSeals> seals_;            ///< until the shell has closed the link: a Goodbye follows its end
  std::vector<LinkId> fresh_;                    ///< have something unsealed for which no time is set yet
  std::optional<MonotonicTime> next_seal_;
};

}  // namespace trb::router
