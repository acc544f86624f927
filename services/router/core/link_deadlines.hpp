// When which link, and which peer without one, is due: with a thousand peers, a walk over all of them for each frame
// would be what a router mostly does.
#pragma once

#include <map>
#include <optional>
#include <string_view>
#include <vector>

#include "common/base/deadline_index.hpp"
#include "common/base/lookup_table.hpp"
#include "services/router/core/config.hpp"
#include "services/router/core/peers.hpp"

namespace trb::router {

/// Whoever may change a row touches it; a touched row is looked at again before the next question is answered.
///
/// row  | due
/// -----|-----------------------------------------------------------------------------------------------------------
/// link | not up: the end of its handshake; up: its next keep-alive, or a lease after the last sign of life
/// link | up: the end of the peer's certificate, in UTC
/// peer | without a link: its next dial, and the end of its lease
class LinkDeadlines {
 public:
  explicit LinkDeadlines(const Timing& timing) : timing_(timing) {}
  LinkDeadlines(const LinkDeadlines&) = delete;
  LinkDeadlines& operator=(const LinkDeadlines&) = delete;

  void touch(Link& link);
  void touch(Peer& peer);
  /// The row goes.
  void forget(Link& link);
  void forget(Peer& peer);

  /// Looks at what was touched. The rows are the table's.
  void refresh(std::map<LinkId, Link>& links, const LookupTable<std::string_view, Peer>& peers);
  [[nodiscard]] std::optional<MonotonicTime> earliest() const { return earlier(links_.earliest(), peers_.earliest()); }
  /// By their ids.
  [[nodiscard]] std::vector<Link*> due_links(MonotonicTime now, UtcTime utc) const;
  /// By their ids.
  [[nodiscard]] std::vector<Peer*> due_peers(MonotonicTime now) const;

 private:
  [[nodiscard]] MonotonicTime due(const Link& link) const;
  [[nodiscard]] std::optional<MonotonicTime> due(const Peer& peer) const;
  void renew(std::map<LinkId, Link>& links);

  const Timing timing_;
  DeadlineIndex<Link*> links_;
  DeadlineIndex<Link*, UtcTime> ends_;
  DeadlineIndex<Peer*> peers_;
  std::vector<Link*> touched_links_;
  std::vector<Peer*> touched_peers_;
};

}  // namespace trb::router
