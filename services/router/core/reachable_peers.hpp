// A relay's side: it notifies each of its links which peers it reaches, and passes on what these send each other.
#pragma once

#include <optional>
#include <set>
#include <string>

#include "services/router/core/own_messages.hpp"
#include "services/router/core/peer_table.hpp"

namespace trb::router {

/// peer    | event                          | next
/// --------|--------------------------------|-----------------------------------------------------------------------
/// any     | its link is up, or gone        | changed; gathered for 0.1 s: a fleet forms all at once
/// changed | 0.1 s (expired)                | sent: every other link gets `neighbours`
/// -       | a new link                     | it gets all that are reached
/// `relayed` for a peer that is linked      | passed on; one hop only
/// `relayed` signed by another (invalid)    | refused: second_hop
/// `relayed` for a peer that is not linked (invalid)| `relay_refused` to its sender
/// more than kCarriedOfOne of one sender in a second| `relay_refused`: others' messages go to the same links
class ReachablePeers {
 public:
  ReachablePeers(const LocalNode& node, PeerTable& table, OwnMessages& messages)
      : node_(node), table_(table), messages_(messages) {}

  /// The peer's link is up, or gone.
  void on_change(const std::string& peer, Now now);
  /// Notifies a new link of all peers.
  void notify_all(const Link& to, Effects& out);
  /// The same once more, with those that are not reached: of some the peer was not told.
  void notify_anew(const Link& to, Effects& out);
  /// Passes on what the peer of this link has wrapped for another one.
  void pass_on(const Link& link, const Message& message, const Relayed& body, const RelayedFrame& inner, Now now,
               Effects& out);
  /// A frame of this peer could not be passed on: the peer is notified.
  void refuse(const Link& to, const RelayedFrame& inner, Errc reason, Effects& out);

  void tick(Now now, Effects& out);
  [[nodiscard]] std::optional<MonotonicTime> next_deadline() const { return next_; }

 private:
  void notify(const Link& to, const std::set<std::string>& about, Effects& out);

  const LocalNode& node_;
  PeerTable& table_;
  OwnMessages& messages_;
  std::set<std::string> changed_;  ///< not sent to the peers yet
  std::optional<MonotonicTime> next_;
};

/// Counts and logs a `relayed` that this relay should not have brought.
void refuse_relayed(const Link& relay, std::string_view reason, const std::string& text, Effects& out);

}  // namespace trb::router
