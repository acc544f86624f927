// Beacons: this node's own, and what others' say about their addresses. A hint, not a proof, but signed.
#pragma once

#include <optional>
#include <string>
#include <string_view>

#include "services/router/core/links.hpp"
#include "services/router/core/trust_store.hpp"

namespace trb::router {

/// own    | event                                   | next
/// -------|-----------------------------------------|------------------------------------------------------------
/// silent | begin(): this node starts, or is a member again | every 5 s; after the start or a move three, 0.3 s apart
/// any    | stop(): no address, or not a member     | silent
/// sends  | a beacon of a node with a smaller id     | sends; the next within 0.2 s, so that it is dialled
///
/// others'                                                   | what follows
/// ----------------------------------------------------------|----------------------------------------------
/// of the link's boot and address                            | the peer's clock is noted anew
/// new boot, new address, or the peer has no link            | dialled, or awaited; a link to the old one ends
/// nothing new, and one was checked 2 s ago                  | nothing; its signature is not checked
/// older than one that was received (repeated)               | refused as replayed
/// forged, over 512 a second, no room in the table (invalid) | refused, counted, a link error
class Beacons {
 public:
  Beacons(const LocalNode& node, PeerTable& table, TrustStore& trust, Links& links, LinkErrors& errors)
      : node_(node), table_(table), trust_(trust), links_(links), errors_(errors) {}

  /// Sends beacons from now on, if this node should and has an address.
  void begin(Now now);
  /// Begins again with a burst: the others should learn the new address soon.
  void burst(Now now);
  void stop() { next_.reset(); }

  /// A datagram on the beacons' port that the fleet's key opened.
  void on_beacon(BytesView plain, Now now, Effects& out);
  /// A datagram that the fleet's key did not open.
  void refuse(std::string_view reason, const std::string& text, Now now, Effects& out);

  void tick(Now now, Effects& out);
  [[nodiscard]] std::optional<MonotonicTime> next_deadline() const { return next_; }

 private:
  [[nodiscard]] bool is_repeated(const std::string& signer, const Beacon& beacon, Now now) const;
  Result<Certificate> check(const SignedRecord& record, const Beacon& beacon, Now now, Effects& out);
  [[nodiscard]] bool is_replayed(const Peer& peer, const Certificate& certificate, const Beacon& beacon) const;
  void follow(Peer& peer, const Beacon& beacon, Now now, Effects& out);
  void note_clock(const Peer& peer, std::int64_t utc, Now now);

  const LocalNode& node_;
  PeerTable& table_;
  TrustStore& trust_;
  Links& links_;
  LinkErrors& errors_;
  std::optional<MonotonicTime> next_;
  MonotonicTime last_;
  std::uint32_t early_ = 3;  ///< still to be sent in a burst
  std::uint64_t count_ = 0;
  Budget budget_{kBeaconsChecked};
};

}  // namespace trb::router
