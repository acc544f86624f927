// What a node knows of its ways by relays: a row a peer, and which row is due when.
#pragma once

#include <map>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "common/base/deadline_index.hpp"
#include "services/router/core/budget.hpp"
#include "services/router/core/local_node.hpp"
#include "services/router/core/local_profile.hpp"
#include "services/router/core/peer_table.hpp"
#include "services/router/core/relay_connection.hpp"

namespace trb::router {

/// What this node knows about the way to one peer by relays.
struct RelayRoute {
  std::uint64_t number = 0;      ///< of the peer: another computer of the same name begins anew
  std::set<std::string> relays;  ///< members that say they reach it
  std::string carrier;           ///< the one of them that gets messages for it
  bool open = false;             ///< there is no link, but this way is open
  RelayConnection connection;
  Bytes key;                           ///< encrypts what goes that way; empty until needed
  std::uint64_t told_profile = 0;      ///< number of this node's profile that was sent to it last
  MonotonicTime profile_told_at{};     ///< when
  std::map<std::string, Budget> load;  ///< by relay: what it brings from this peer
  std::optional<MonotonicTime> due;    ///< its slot in the index
};

/// Whoever may change a row takes it by row(), which touches it; touched rows are looked at again before the next
/// question is answered. With a thousand peers behind a relay, a walk over all of them for each frame would be what the
/// router mostly does.
class RelayTable {
 public:
  RelayTable(const LocalNode& node, const PeerTable& peers, const LocalProfile& profile)
      : node_(node), peers_(peers), profile_(profile) {}

  /// The peer's row; a new one for a peer, or another computer of its name, that has none.
  RelayRoute& row(const Peer& peer);
  /// The peer's row, or an empty one.
  [[nodiscard]] const RelayRoute& find(const Peer& peer) const;
  [[nodiscard]] const std::map<std::string, RelayRoute, std::less<>>& rows() const { return rows_; }

  /// By id: whose way is open.
  [[nodiscard]] const std::set<std::string, std::less<>>& open() const;
  /// By id: whose way is open, who has no link, and who does not have this node's newest profile.
  [[nodiscard]] const std::set<std::string, std::less<>>& untold() const;
  /// By id: who is due, but for profiles.
  [[nodiscard]] std::vector<std::string> due(MonotonicTime now) const;
  [[nodiscard]] std::optional<MonotonicTime> earliest() const;

  /// Rows of peers that are forgotten go.
  void drop_without_peer();

 private:
  void refresh() const;
  void refresh(RelayRoute& route, const std::string& id) const;

  const LocalNode& node_;
  const PeerTable& peers_;
  const LocalProfile& profile_;
  mutable std::map<std::string, RelayRoute, std::less<>> rows_;  ///< by peer, once there was anything to know
  mutable DeadlineIndex<std::string> due_;
  mutable std::vector<std::string> touched_;
  mutable std::set<std::string, std::less<>> open_;
  mutable std::set<std::string, std::less<>> untold_;
  mutable std::uint64_t newest_profile_ = 0;  ///< when `untold_` was made
  std::uint64_t forgotten_ = 0;               ///< peers, when the rows were last compared
};

}  // namespace trb::router
