// Applies core/pending_connections.hpp to the descriptors of the inbox's pending connections.
#pragma once

#include <functional>
#include <map>
#include <string>

#include "common/transport/loop.hpp"
#include "common/transport/monitor.hpp"
#include "common/transport/source_filter.hpp"
#include "services/router/core/pending_connections.hpp"

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

 private:
  struct Connection {
    int fd = -1;
    RemoteEnd end;
  };
  void on_accepted(int fd);
  void carry_out();
  void set_filter();

  std::function<void(const std::string&)> on_blocked_;
  std::function<void(const std::string&)> on_cut_;
  std::function<std::vector<std::string>()> friends_;
  PendingConnections pending_connections_;
  SourceFilter filter_;
  std::map<int, PendingConnectionId> by_fd_;
  std::map<PendingConnectionId, Connection> connections_;
};

/// Raises the limit of descriptors as far as the system allows, and returns it.
std::size_t raise_descriptor_limit();

}  // namespace trb::router
