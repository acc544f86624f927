// This node: its configuration, its own certificate, its addresses, and a lower bound of the time.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "services/router/core/clock_bound.hpp"
#include "services/router/core/config.hpp"
#include "services/router/core/effects.hpp"

namespace trb::router {

class LocalNode {
 public:
  explicit LocalNode(RouterConfig config) : config_(std::move(config)) {}

  [[nodiscard]] const RouterConfig& config() const { return config_; }
  [[nodiscard]] const std::string& id() const { return config_.id; }
  /// Of two nodes that could dial each other, the smaller id does.
  [[nodiscard]] bool is_smaller_than(std::string_view other) const { return config_.id < other; }
  /// It may relay, and is configured to.
  [[nodiscard]] bool relays() const { return config_.relay && config_.own.relay; }
  /// An unpredictable number.
  [[nodiscard]] std::uint64_t random() const { return config_.random(); }

  /// A newer certificate of this node.
  void renew(const SignedRecord& record, const Certificate& certificate);

  /// The inbox has this address from now on; empty: none, and `why` says what is awaited. False: nothing changed.
  bool move_to(const std::string& address, const std::string& why);
  /// Why this node has no address; empty if it has one.
  [[nodiscard]] const std::string& waits_for() const { return waits_for_; }
  /// Where the own lossy lane can be dialled; empty: nowhere.
  void set_lane(const std::string& address) { config_.lane = address; }

  /// A clock that is behind the lower bound is wrong: then the bound counts.
  [[nodiscard]] UtcTime checked_utc(UtcTime utc) const;
  [[nodiscard]] bool knows_the_time(Now now) const { return checked_utc(now.utc) == now.utc; }
  void start_clock(Now now) { clock_.start(config_.utc_bound, now); }
  /// The authority has signed something at this time, so it has passed; stored if that is new.
  void raise_utc_bound(UtcTime utc, Effects& out);
  /// Each turn. `peers`: UTC at monotonic 0 by each of their verified clocks.
  void note_time(Now now, const PeerClocks& peers, Effects& out);
  [[nodiscard]] bool clock_is_steady(Now now) const { return clock_.is_steady(now); }

 private:
  RouterConfig config_;
  std::string waits_for_;
  ClockBound clock_;
};

}  // namespace trb::router
