// The rows of the routing table: who is known, by which link, until when.
#pragma once

#include <deque>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <string_view>

#include "common/base/result.hpp"
#include "common/base/time.hpp"
#include "common/security/keys.hpp"
#include "proto/bodies/link.hpp"
#include "services/router/core/budget.hpp"
#include "services/router/core/config.hpp"
#include "services/router/core/effects.hpp"
#include "services/router/core/lane.hpp"

namespace trb::router {

/// The goodbye of a lease that ended in silence: the other side learns by it that it is not heard.
constexpr std::string_view kUnheard = "nothing heard for a lease";

/// One CURVE connection. Down = not in the table.
struct Link {
  LinkId id = 0;
  bool dialled = false;                     ///< by this node
  std::string peer;                         ///< empty until its Hello was accepted
  Bytes key;                                ///< the other side's CURVE key
  std::string address;                      ///< that was dialled
  std::string own_address;                  ///< where this node could be dialled when it said Hello here
  bool relay = false;                       ///< the other side relays, and its certificate lets it
  std::optional<std::int64_t> utc_at_zero;  ///< by the other side's clock, if it is verified: UTC at monotonic 0
  std::string peer_address;                 ///< where the other side said that it could be
  bool up = false;                          ///< Hello heard and accepted
  /// Its Hello came while another link was up or being dialled, and nothing since: its dialler may have given it up
  /// before this node read it. It carries nothing until one more word comes by it.
  std::optional<Hello> waiting;
  bool hello_sent = false;
  std::uint64_t profile = 0;  ///< number of this node's profile that the other side was last told
  std::uint64_t boot = 0;     ///< the peer's boot counter, from its Hello
  std::uint64_t heard = 0;    ///< last sequence heard
  MonotonicTime opened;
  MonotonicTime last_heard;
  MonotonicTime confirmed;  ///< when the peer was last known to hear us
  MonotonicTime next_keep_alive;
  std::deque<std::uint64_t> unconfirmed;  ///< sequences of our keep-alives not yet echoed
};

/// When to dial, and how patient to be.
struct Redial {
  std::optional<MonotonicTime> at;
  Duration wait{};
  LinkId link = 0;  ///< being dialled now
};

struct Peer {
  std::string id;
  std::uint64_t number = 0;  ///< of its own, never used again: whose answers count, without comparing names
  SignedRecord certificate_record;
  Certificate certificate;
  std::string address;       ///< where it says that it can be dialled
  std::string good_address;  ///< where this node has reached it, if that is another one: a seed's, behind a translator
  bool try_good = false;     ///< the next dial goes there
  std::uint64_t boot = 0;
  Budget hellos{kHellosOfOne};
  ByteRate answers{kAnsweredOfOne};       ///< tables that it asked for
  Budget updates{kUpdatesOfOne};          ///< trust updates that it brings
  Budget update_checks{kUpdatesChecked};  ///< signatures in them
  Budget reach_checks{kReachChecked};     ///< signatures of whom it reaches
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
  MonotonicTime comes_until{};  ///< its own dial has arrived, and has this long to send its Hello
  Spare spare;
};

struct Seed {
  std::string address;
  Bytes key;
  std::string peer;  ///< whose key it is, once known
  Redial redial;
  bool hint = false;  ///< from the last run, not from node.json: given up for the peer's own address once it was met
};

/// An address that another node tells is numbers, or empty: to ask a name server where it is would wait for one, as
/// long as that likes. Errors: bad_value, naming the field.
Status check_address(std::string_view field, std::string_view address, std::string_view whose);

/// A profile that may be kept and told on: kMaxProfileSize.
bool fits(const NodeProfile& profile);

/// Of two links to one peer: does the new one take the old one's place? Both sides come to the same answer.
/// A higher boot counter wins (the old process is gone); else, if either side has another address than when the old
/// link was made, the new one: that side has moved, and the old link leads to where it was; else the link dialled by
/// the smaller id; else, dialled by the same side, the newer: a dialler makes a second link only when its first is
/// dead.
bool new_link_wins(const Link& old_link, const Link& new_link, bool own_id_is_smaller);

}  // namespace trb::router
