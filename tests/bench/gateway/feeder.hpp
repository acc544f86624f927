// The gateway's router and all that lies behind it: its bus over TCP with CURVE, the tap, and robots that change.
#pragma once

#include <map>
#include <memory>
#include <optional>

#include "common/config/node_config.hpp"
#include "common/security/node_keys.hpp"
#include "common/transport/zap.hpp"
#include "proto/body.hpp"
#include "proto/message.hpp"
#include "tests/bench/gateway/crowd.hpp"

namespace trb::bench {

/// It takes the router's place at the bus of one node, with that node's keys: it welcomes who has a key of keys/bus,
/// answers what the gateway asks its node (routes, runs, alerts, signatures) and its robots (place, charge), shows
/// every message at the tap, and sends each robot's changes as that robot's router would have handed them on.
class Feeder {
 public:
  Feeder(NodeConfig config, NodeKeys keys, int robots, double changes);

  /// Binds bus and tap. Errors: those of the keys in keys/bus; io_error naming the address.
  Status open();
  /// Until SIGTERM. Then prints what was sent, what found no room, and how late the latest change was, as JSON.
  void run();

 private:
  struct Connection {
    ServiceHello hello;
    std::uint16_t slot = 0;
  };

  Result<CurveKeys> read_keys();
  void drain_bus();
  void drain_tap();
  void on_message(const Bytes& from, const Message& message);
  void on_hello(const Bytes& from, const Message& message);
  void on_request(const Bytes& from, const Message& message);
  void on_robot_request(const Bytes& from, const Message& message);
  void feed(MonotonicTime now);
  void tell(const Crowd::Change& change);
  [[nodiscard]] RouteTable routes_after(const std::string& after) const;
  void answer(const Bytes& from, const Message& question, const std::string& source, const Body& body);
  void send(const Bytes& to, const Message& message);
  void show(char direction, BytesView frame);

  NodeConfig config_;
  NodeKeys keys_;
  Crowd crowd_;
  std::map<std::string, int> numbers_;  ///< of the robots, by name
  std::vector<std::uint64_t> told_;     ///< each robot's last change
  Context context_;
  Loop loop_;
  std::map<Bytes, std::string, std::less<>> names_;  ///< by public key
  std::optional<ZapServer> zap_;
  std::optional<Socket> bus_;
  std::optional<Socket> tap_;
  int listeners_ = 0;
  std::map<Bytes, Connection> connections_;
  std::uint64_t last_id_ = 0;
  std::uint64_t sent_ = 0;
  std::uint64_t full_ = 0;
  Duration latest_{0};
};

}  // namespace trb::bench
