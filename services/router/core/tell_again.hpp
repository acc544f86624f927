// What a peer must know of this node and was not told, because its link had no room: it is told again.
#pragma once

#include <map>
#include <optional>
#include <string_view>
#include <utility>

#include "common/base/deadline_index.hpp"
#include "services/router/core/local_profile.hpp"
#include "services/router/core/peer_table.hpp"
#include "services/router/core/reachable_peers.hpp"
#include "services/router/core/trust_updates.hpp"

namespace trb::router {

constexpr Duration kTellAgain = std::chrono::seconds(1);

/// profile, trust updates or neighbours, of one peer | event                        | next
/// --------------------------------------------------|------------------------------|--------------------------------
/// told                                              | its link takes no such word  | untold
/// untold                                            | another one (repeated)       | untold
/// untold                                            | 1 s (expired)                | told anew and in whole
/// untold                                            | its link is gone             | told: a new one is told all
class TellAgain {
 public:
  TellAgain(PeerTable& table, LocalProfile& profile, TrustUpdates& updates, ReachablePeers& reachable)
      : table_(table), profile_(profile), updates_(updates), reachable_(reachable) {}

  /// This message of the router did not leave; most may be lost.
  void on_unsent(const Message& message, Now now);
  void tick(Now now, Effects& out);
  [[nodiscard]] std::optional<MonotonicTime> next_deadline() const { return due_.earliest(); }

 private:
  enum class What : unsigned char { profile, updates, neighbours };
  using Untold = std::pair<LinkId, What>;
  [[nodiscard]] static std::optional<What> what_is(std::string_view subtype);
  void tell(Link& link, What what, Now now, Effects& out);

  PeerTable& table_;
  LocalProfile& profile_;
  TrustUpdates& updates_;
  ReachablePeers& reachable_;
  std::map<Untold, DeadlineIndex<Untold>::Slot> slots_;
  DeadlineIndex<Untold> due_;
};

}  // namespace trb::router
