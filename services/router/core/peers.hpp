// The rows of the routing table: which peers are known, by which link, until when.
#pragma once

#include <map>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <string_view>
#include <vector>

#include "common/base/result.hpp"
#include "common/base/time.hpp"
#include "common/security/keys.hpp"
#include "proto/bodies/link.hpp"
#include "services/router/core/budget.hpp"
#include "services/router/core/config.hpp"
#include "services/router/core/effects.hpp"
#include "services/router/core/lane.hpp"

namespace trb::router {

/// The reason of a Goodbye after a silent lease: it informs the other side that it is not heard.
constexpr std::string_view kUnheard = "nothing heard for a lease";

/// Kept by LinkDeadlines: when the row is held to be due.
struct RowDue {
  bool touched = false;             ///< it is looked at again
  std::optional<MonotonicTime> at;  ///< of a link, or a peer
  std::optional<UtcTime> ends;      ///< the peer's certificate
};

/// One CURVE connection. Down = not in the table.
struct Link {
  LinkId id = 0;
  bool dialled = false;                     ///< by this node
  std::string peer;                         ///< empty until its Hello was accepted
  Bytes key;                                ///< the other side's CURVE key
  std::string address;                      ///< that was dialled
  std::string dialled_for;                  ///< the peer whose Redial it is; empty: a seed's, or accepted
  std::string own_address;                  ///< where this node could be dialled when it said Hello here
  bool relay = false;                       ///< the other side relays, and its certificate allows it
  std::optional<std::int64_t> utc_at_zero;  ///< by the other side's clock, if it is verified: UTC at monotonic 0
  std::string peer_address;                 ///< where the other side announced that it could be dialled
  bool up = false;                          ///< Hello received and accepted
  /// Its Hello came while another link was up or being dialled, and nothing since: the dialler may have given it up
  /// before this node read it. It carries nothing until one more message comes by it.
  std::shared_ptr<const Hello> waiting;
  bool hello_sent = false;
  bool told_early = false;    ///< the other side, dialled, brought a trust update before its Hello: once is enough
  std::uint64_t profile = 0;  ///< number of this node's profile that was last sent to the other side
  std::uint64_t boot = 0;     ///< the peer's boot counter, from its Hello
  std::uint64_t heard = 0;    ///< last sequence number received
  MonotonicTime opened;
  MonotonicTime last_heard;
  MonotonicTime confirmed;  ///< when the peer was last known to receive from us
  MonotonicTime next_keep_alive;
  std::vector<std::uint64_t> unconfirmed;  ///< sequences of our keep-alives not yet echoed
  RowDue due;
};

/// When to dial, and with how much back-off.
struct Redial {
  std::optional<MonotonicTime> at;
  Duration wait{};
  LinkId link = 0;  ///< being dialled now
};

struct Peer {
  std::string id;
  std::uint64_t number = 0;  ///< unique, never reused: answers are checked by it, not by name
  SignedRecord certificate_record;
  Certificate certificate;
  std::string address;       ///< where it announces that it can be dialled
  std::string good_address;  ///< where it was reached, if elsewhere: a seed's address, behind NAT
  bool try_good = false;     ///< the next dial goes there
  std::uint64_t boot = 0;
  Budget hellos{kHellosOfOne};
  ByteRate answers{kAnsweredOfOne};       ///< tables that it requested
  Budget updates{kUpdatesOfOne};          ///< trust updates that it brings
  Budget update_checks{kUpdatesChecked};  ///< signatures in them
  Budget reach_checks{kReachChecked};     ///< signatures of whom it reaches
  Budget carried{kCarriedOfOne};          ///< what it has this node pass on as a relay
  Budget relayed_forged{kRelayedForged};  ///< what it brings as a relay and nobody has signed
  Budget invitation_checks{kInvitationsOfOne};
  std::uint64_t beacon_boot = 0;
  std::uint64_t beacon_count = 0;
  MonotonicTime last_beacon;
  std::string version;
  bool clock_verified = true;
  NodeProfile profile;
  LinkId link = 0;  ///< the link that is up, or 0
  bool expired = false;
  bool met = false;                   ///< was linked at least once
  std::optional<MonotonicTime> lost;  ///< since when the lease runs: the last sign of life on the link that went down
  MonotonicTime last_heard;
  Redial redial;
  MonotonicTime comes_until{};  ///< its own dial has arrived: until when its Hello may come
  MonotonicTime out_until{};    ///< it is neither dialled nor let in: it sent parts of a message without end
  Spare spare;
  RowDue due;
};

struct Seed {
  std::string address;
  Bytes key;
  std::string peer;  ///< the owner of the key, once known
  Redial redial;
  bool hint = false;  ///< from the last run, not node.json: once met, the peer's own address replaces it
};

/// An address from another node must be numeric, or empty: resolving a name would block for as long as the name server
/// takes. Errors: bad_value, naming the field.
Status check_address(std::string_view field, std::string_view address, std::string_view whose);

/// May this profile be kept and passed on? At most kMaxProfileSize.
bool fits(const NodeProfile& profile);

/// Of two links to one peer: does the new one replace the old one? Both sides come to the same answer. A higher boot
/// counter wins (the old process is gone). Else, if either side has another address than when the old link was made,
/// the new one wins: that side has moved. Else the link dialled by the smaller id wins. Else, dialled by the same side,
/// the newer: a dialler makes a second link only when its first is dead.
bool new_link_wins(const Link& old_link, const Link& new_link, bool own_id_is_smaller);

}  // namespace trb::router
