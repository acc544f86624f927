// Who belongs to the fleet now: what a new revocation list does to peers, and whether this node itself is a member.
#pragma once

#include <optional>
#include <string>

#include "services/router/core/admission.hpp"
#include "services/router/core/beacons.hpp"
#include "services/router/core/links.hpp"
#include "services/router/core/trust_store.hpp"

namespace trb::router {

/// this node | event                                             | next
/// ----------|---------------------------------------------------|-----------------------------------------------
/// member    | its certificate is revoked, or ends (expired)     | muted: no beacon, no dial, its links end
/// member    | it starts, and cannot read who is revoked         | muted, and lets nobody in, until it is started again
/// muted     | a renewed certificate, or a clock that was ahead  | member: beacons and dials at once
/// member    | 30 days before the end                            | member; a warning once a day
///
/// a peer    | a list revokes it                                 | - : links end, its key is refused, its row is gone
class Membership {
 public:
  Membership(LocalNode& node, PeerTable& table, TrustStore& trust, Links& links, Beacons& beacons, Admission& admission,
             LinkErrors& errors)
      : node_(node),
        table_(table),
        trust_(trust),
        links_(links),
        beacons_(beacons),
        admission_(admission),
        errors_(errors) {}

  /// A new list is in force.
  void apply_revocations(Now now, Effects& out);
  /// Is this node still a member, or again? Each turn, and when a trust update came.
  void check_own(Now now, Effects& out);
  /// This node has a new certificate: its end is warned of anew.
  void on_renewed() { warned_.reset(); }
  /// This node (then all of its links), or a peer, may relay now, or may no longer: a Hello says which, once for a
  /// link.
  void on_relay_right(const std::string& id, Now now, Effects& out);
  /// No other node accepts this one.
  [[nodiscard]] bool is_muted() const { return muted_; }
  /// For people: why this node has no links, or that its certificate ends soon; may be empty.
  [[nodiscard]] std::string note(Now now) const;
  /// Each turn: stores the lower bound of the time now and then.
  void note_time(Now now, Effects& out);
  [[nodiscard]] std::optional<MonotonicTime> next_deadline() const { return next_check_; }

 private:
  void put_out(const std::string& id, Now now, Effects& out);
  void mute(const std::string& why, Now now, Effects& out);
  void unmute(Now now, Effects& out);
  [[nodiscard]] std::string why_over(Now now) const;
  void warn_of_end(Now now, Effects& out);

  LocalNode& node_;
  PeerTable& table_;
  TrustStore& trust_;
  Links& links_;
  Beacons& beacons_;
  Admission& admission_;
  LinkErrors& errors_;
  bool muted_ = false;
  std::optional<UtcTime> warned_;
  std::optional<MonotonicTime> next_check_;  ///< while the own certificate is not valid
};

}  // namespace trb::router
