// Addresses of the peers that were linked: hints for the next start, stored a little after a change.
#pragma once

#include <optional>

#include "services/router/core/peer_table.hpp"

namespace trb::router {

/// state   | event                  | next
/// --------|------------------------|----------------------------------------------
/// written | an address has changed | changed: changes of 5 s are gathered
/// changed | 5 s (expired)          | written (StorePeers)
class KnownAddresses {
 public:
  explicit KnownAddresses(const PeerTable& table) : table_(table) {}

  void on_change(Now now) {
    if (!next_) next_ = now.mono + kStorePause;
  }
  void tick(Now now, Effects& out);
  [[nodiscard]] std::optional<MonotonicTime> next_deadline() const { return next_; }

 private:
  const PeerTable& table_;
  std::optional<MonotonicTime> next_;
};

}  // namespace trb::router
