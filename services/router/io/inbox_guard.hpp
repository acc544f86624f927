// Applies core/pending_connections.hpp and incomplete_bytes.hpp to the descriptors of the inbox's connections.
#pragma once

#include <deque>
#include <functional>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "common/transport/incomplete_bytes.hpp"
#include "common/transport/loop.hpp"
#include "common/transport/monitor.hpp"
#include "common/transport/source_filter.hpp"
#include "services/router/core/pending_connections.hpp"
#include "services/router/io/look_round.hpp"

namespace trb::router {

class InboxGuard {
 public:
  /// `on_blocked` gets each source that is kept out from now on, `on_cut` each connection whose time is over.
  InboxGuard(Loop& loop, PendingConnectionLimits limits, std::function<void(const std::string& source)> on_blocked,
             std::function<void(const std::string& address)> on_cut);

  /// Every event of the inbox's monitor.
  void on_event(LinkEvent event, int fd);
  /// The inbox is closed, and every connection with it.
  void reset();
  /// Is the connection on this descriptor neither a link nor refused by a message?
  [[nodiscard]] bool is_undecided(int fd) const;
  /// The pending connection on this descriptor now; 0: none.
  [[nodiscard]] PendingConnectionId pending(int fd) const;
  void linked(PendingConnectionId pending);
  /// Its link has ended, or was refused: cuts it after a delay, so that the last message can be read.
  void leave(PendingConnectionId pending);
  /// Provides the sources that are let in while the inbox is closed to everybody else.
  void set_friends(std::function<std::vector<std::string>()> friends) { friends_ = std::move(friends); }

  // ---- messages without a last part

  /// The connection carries messages: each frame received from it is added to what this returns. Any other may send
  /// kMostUnproven bytes in all.
  std::shared_ptr<IncompleteBytes> carries(PendingConnectionId pending);
  /// Each connection carries messages from the beginning.
  void all_carry() { all_carry_ = true; }
  /// Gets each connection that is cut because it sent too much that is not complete.
  using OnIncomplete = std::function<void(PendingConnectionId pending, const std::string& address)>;
  void set_on_incomplete(OnIncomplete on_incomplete) { on_incomplete_ = std::move(on_incomplete); }
  /// Looks at this part of the connections, now and then; libzmq's own words between two programs may take `own_words`
  /// bytes of each in a second. True: the socket must be read until it is empty, for on_empty().
  bool look(std::uint64_t own_words = 0, const LookPart& part = {});
  /// How many there are.
  [[nodiscard]] std::size_t connections() const { return connections_.size(); }
  /// The socket had no message left.
  void on_empty();
  /// So many messages were received from the socket in one turn, and it may have more.
  void on_turn(std::size_t messages);

 private:
  struct Connection {
    int fd = -1;
    RemoteEnd end;
    MonotonicTime accepted;
    std::shared_ptr<IncompleteBytes> incomplete;  ///< of one that carries messages
    bool leaving = false;
  };
  struct Suspect {
    PendingConnectionId id = 0;
    std::uint64_t enough = 0;  ///< when so many messages were received, every queue of its look was empty once
  };
  void on_accepted(int fd);
  void carry_out();
  void suspect(PendingConnectionId id);
  void conclude(std::size_t first);
  void cut_incomplete(const std::vector<PendingConnectionId>& all);
  void set_filter();

  std::function<void(const std::string&)> on_blocked_;
  std::function<void(const std::string&)> on_cut_;
  std::function<std::vector<std::string>()> friends_;
  OnIncomplete on_incomplete_;
  bool all_carry_ = false;
  PendingConnections pending_connections_;
  SourceFilter filter_;
  std::map<int, PendingConnectionId> by_fd_;
  std::map<PendingConnectionId, Connection> connections_;
  LookCursor cursor_;
  std::deque<Suspect> suspects_;  ///< in the order of the looks
  std::uint64_t received_ = 0;    ///< messages, in turns that did not empty the socket
};

/// Raises the limit of descriptors as far as the system allows, and returns it.
std::size_t raise_descriptor_limit();

}  // namespace trb::router
