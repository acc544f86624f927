// The lossy lanes of all links: which peers listen to this node's, and which of theirs are dialled.
#pragma once

#include <map>
#include <optional>
#include <string>

#include "common/base/deadline_index.hpp"
#include "services/router/core/lane.hpp"
#include "services/router/core/link_end_reason.hpp"
#include "services/router/core/local_node.hpp"
#include "services/router/core/peer_table.hpp"

namespace trb::router {

constexpr Duration kLaneAfter = std::chrono::milliseconds(500);  ///< from the link to the first dial: links come first
constexpr Duration kLaneFirst = std::chrono::milliseconds(200);  ///< before the lane is dialled again; doubled
constexpr Duration kLaneMost = std::chrono::seconds(30);

/// What a node knows about the lanes of one link: its own and the other side's.
struct Lane {
  std::string address;                     ///< where the other side's lane can be dialled; empty: it has none
  std::optional<MonotonicTime> dial_at;    ///< empty while it is dialled or received; set by the table alone
  std::optional<MonotonicTime> connected;  ///< since when it is received
  Duration wait{};                         ///< before the last dial
  bool listens = false;                    ///< the other side listens to this node's lane
  bool barred = false;                     ///< it misused this node's lane
};

/// other's lane | event                     | next
/// -------------|---------------------------|--------------------------------------------------------------------
/// -            | the link is up            | waiting: dialled after 0.5 s, if the other side has a lane
/// waiting      | its time (expired)        | dialled (DialLane)
/// dialled      | connected                 | received
/// any          | ended                     | waiting: 0.2 s to 30 s, doubled; from 0.2 s if it lasted a lease
/// any          | parts without end         | -, until the link has ended
/// any          | the link ends             | -
///
/// own lane     | event                     | next
/// -------------|---------------------------|--------------------------------------------------------------------
/// silent       | subscribes to its topic   | listens
/// silent       | to another topic (invalid)| silent, refused
/// any          | another message (invalid) | barred until its link has ended
/// listens      | its connection ends       | silent
class LaneTable {
 public:
  LaneTable(const LocalNode& node, PeerTable& table) : node_(node), table_(table) {}

  // ---- the other side's lane

  /// The link is up: its lane is dialled soon, if the Hello names one.
  void open(const Link& link, const Hello& hello, Now now);
  void on_connected(LinkId link, Now now);
  void on_ended(LinkId link, LinkEndReason how, Now now, Effects& out);
  /// It sent parts of a message without end: not dialled again beside this link.
  void on_incomplete(LinkId link, Effects& out);

  // ---- this node's lane

  /// ZAP: only peers with a link that is up may listen.
  bool admit(BytesView key, Effects& out);
  /// A connection of this key subscribes to `topic`. Returns its link; nothing if it is refused and has to be cut.
  std::optional<LinkId> on_listen(BytesView key, BytesView topic, Effects& out);
  void on_listener_gone(LinkId link);
  /// The connection sent something that is not a subscription.
  void bar(BytesView key, Effects& out);
  /// The listener of this link sent more than subscriptions.
  void bar(LinkId link, Effects& out);
  [[nodiscard]] bool listens(LinkId link) const;

  /// The default for an unknown link.
  [[nodiscard]] Lane of(LinkId link) const;
  void tick(Now now, Effects& out);
  [[nodiscard]] std::optional<MonotonicTime> next_deadline() const;

 private:
  /// The lane of the peer with this key, if its link is up and it is not barred.
  Link* listener(BytesView key);
  Lane* row(LinkId link);
  void drop_rows_without_link();

  const LocalNode& node_;
  PeerTable& table_;
  std::map<LinkId, Lane> rows_;  ///< those of links that are gone are removed by the next tick
  DeadlineIndex<LinkId> dials_;
  std::uint64_t removed_ = 0;  ///< links, when the rows were last compared
};

}  // namespace trb::router
