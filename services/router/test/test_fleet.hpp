// A fleet of routers, for tests: the simulator's world plays them, a test moves their clock and sees what each core
// orders.
#pragma once

#include <algorithm>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "services/router/core/router_core.hpp"
#include "services/router/test/test_keys.hpp"
#include "services/router/test/test_words.hpp"
#include "services/simulator/world/router_process.hpp"

namespace trb::router {

constexpr Duration kStep = milliseconds(10);
constexpr Duration kInstant{1};
constexpr Duration kOnTheWay = std::chrono::microseconds(500);  ///< how long a message is

/// One node: its router, and what that has ordered.
struct TestNode {
  TestNode(RouterConfig config, world::Events& events, world::Network& network, world::Meter& meter)
      : clock(events), router(std::move(config), utc_bound, events, clock, network, meter), core(&router.core()) {}

  std::string id;
  TestKeys keys;
  UtcTime utc_bound;
  world::Clock clock;
  world::RouterProcess router;
  RouterCore* core;
  std::vector<BusSend> bus;
  std::vector<RefuseCandidate> refused;
  std::vector<LinkId> closed;
  std::vector<Dial> dials;
  std::vector<DialLane> lane_dials;
  std::vector<Bytes> beacons;
  std::string stored;  ///< what StorePeers would have written
  enum class Disk : unsigned char { good, full, silent } disk = Disk::good;
  std::size_t stored_boots = 0;  ///< attempts to store the boot number
  std::vector<StoreUpdate> stored_updates;
  std::vector<SignedRecord> stored_certificates;
  std::vector<UtcTime> stored_utc;
  std::vector<std::string> log;
  std::vector<Message> delivered;  ///< for a service, received by a link
  Duration clock_off{};

  [[nodiscard]] std::uint64_t count(const std::string& name) const { return core->counters().value(name); }
  [[nodiscard]] const Peer* peer(const std::string& other) const {
    const auto at = core->table().peers().find(other);
    return at == core->table().peers().end() ? nullptr : &at->second;
  }
  [[nodiscard]] LinkId link_to(const std::string& other) const {
    return peer(other) == nullptr ? 0 : peer(other)->link;
  }
  /// What it knows about the way to another node by relays.
  [[nodiscard]] const RelayRoute& relay_route(const std::string& other) const {
    return core->relays().route(*peer(other));
  }
  [[nodiscard]] std::size_t told(std::string_view subtype) const {
    return static_cast<std::size_t>(
        std::count_if(bus.begin(), bus.end(), [&](const BusSend& send) { return send.message.subtype == subtype; }));
  }
};

class TestFleet {
  world::Events events_;
  world::Meter meter_{1};
  world::Dice dice_{1};
  world::Network network_;

 public:
  TestFleet();
  TestFleet(const TestFleet&) = delete;
  TestFleet& operator=(const TestFleet&) = delete;
  ~TestFleet() { network_.stop(); }

  TestAuthority authority;
  Now now{{1'000'000'000}, {kStartUtc}};

  struct Options {
    std::uint64_t boot = 1;
    bool beacon = true;
    std::vector<std::string> seeds{};
    std::vector<std::string> known{};                  ///< hints of the previous run
    std::map<std::string, std::string> seed_names{};   ///< id -> the HOST:PORT that its seed names
    std::map<std::string, std::string> known_names{};  ///< the same for hints
    bool disk_full = false;                            ///< also when it starts
    bool relay = false;                                ///< its certificate allows it, too
    bool lane = true;
    Role role = Role::robot;
    bool seal_before_delivery = false;
    std::optional<Error> updates_lost{};  ///< it cannot read what the authority has signed
    Duration clock_off{};                 ///< the error of the node's UTC clock
  };

  TestNode& start(const std::string& id, const Options& options);
  TestNode& start(const std::string& id) { return start(id, Options{}); }
  /// Starts ant and bee and lets them run for that time, in which they find each other; returns ant.
  TestNode& start_two(Duration time) {
    TestNode& ant = start("ant");
    start("bee");
    run(time);
    return ant;
  }
  TestNode& at(const std::string& id) { return *nodes_.at(id); }
  /// A node's first numeric address; it need not have been started yet.
  std::string address(const std::string& id);
  /// The keys of a node; it need not have been started yet.
  TestKeys& keys(const std::string& id);

  /// What a name server knows about the hosts that seeds name: HOST:PORT -> address.
  std::map<std::string, std::string>& hosts = network_.names;
  /// Lets time pass; whatever is due happens.
  void run(Duration time);
  /// Nothing sent from one node to the other arrives any more; nobody is notified.
  void cut(const std::string& from, const std::string& to);
  void heal();
  /// The node has another address from now on: its connections lead nowhere, and only its own router is notified.
  void move(const std::string& id, const std::string& address);
  /// May change each message that one node sends the other, or lose it (false).
  std::function<bool(const std::string& from, LinkId link, std::uint64_t& sequence, Message& message)> meddle;
  /// A node that withholds what it should send: the link does not show it.
  std::function<bool(const std::string& from, const Message& message)> withhold;
  /// A service of this node sends another node something, by the call that the shell makes.
  void say(const std::string& from, const std::string& to, const std::string& word, const Bytes& data);
  /// The service on connection 1 of this node requests something from another node.
  void ask(const std::string& from, const std::string& to, const std::string& word, const Bytes& data);
  /// Sends lossy information by whichever way the core chooses; returns that way. What the lane carries arrives at
  /// once.
  Routing stream(const std::string& from, const Message& message);
  /// Does this node receive that one's lane?
  [[nodiscard]] bool receives_lane(const std::string& listener, const std::string& speaker) const {
    return lanes_.count({listener, at_const(listener).link_to(speaker)}) != 0;
  }
  /// The connection of a lane breaks, its link does not.
  void break_lane(const std::string& listener, const std::string& speaker);
  /// The process ends: its connections break.
  void stop(const std::string& id);

  /// The time as this node's clocks tell it.
  [[nodiscard]] Now now_of(const TestNode& node) const { return {now.mono, now.utc + node.clock_off}; }

  void carry_out(TestNode& node, Effects& effects);
  /// Hands a message to a node as if it came by a link, by the call that the shell makes.
  Routing arrive(TestNode& node, LinkId link, std::uint64_t sequence, const Message& message);
  /// A connection of the node's bus sends a message, by the call that the shell makes.
  Routing forward(TestNode& node, ConnectionId from, const Message& message);

 private:
  [[nodiscard]] RouterConfig config_of(const std::string& id, const Options& options);
  [[nodiscard]] world::RouterWatch watch_of(TestNode& node);
  void take(TestNode& node, const Effect& order);
  void keep_time();
  [[nodiscard]] bool meddle_with(const std::string& from, LinkId link, Bytes& frame) const;
  [[nodiscard]] const TestNode& at_const(const std::string& id) const { return *nodes_.at(id); }
  void connect_lane(TestNode& node, const DialLane& dial);
  void close_lanes(const TestNode& node, LinkId link);
  std::uint64_t next_random();

  std::map<std::string, std::unique_ptr<TestNode>> nodes_;
  std::map<std::string, TestKeys> keys_;
  std::map<std::string, std::string> places_;                    ///< HOST:PORT -> id
  std::map<std::string, std::string> addresses_;                 ///< first addresses, by id
  std::map<std::pair<std::string, LinkId>, std::string> lanes_;  ///< (listener, link) -> speaker
  std::set<std::pair<std::string, std::string>> cuts_;
  std::uint64_t random_ = 0;
};

}  // namespace trb::router
