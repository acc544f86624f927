// Connections at the inbox that have proven nothing yet: bounded in number and time; a source with too many is kept
// out.
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "common/base/time.hpp"

namespace trb::router {

/// Identifies a connection for good, unlike its descriptor.
using PendingConnectionId = std::uint64_t;

struct PendingConnectionLimits {
  std::size_t open_from_one = 128;           ///< unproven connections of one source at a time
  std::size_t failures_of_one = 512;         ///< connections of one source that ended without proof, in a window
  std::size_t open = 1024;                   ///< unproven connections in all
  std::size_t sources = 4096;                ///< sources whose failures are remembered
  std::size_t blocked = 64;                  ///< sources kept out at a time
  Duration proof = std::chrono::seconds(4);  ///< from TCP to a link: CURVE has 2 s, then Hello 2 s
  Duration window = std::chrono::seconds(10);
  Duration block = std::chrono::seconds(10);
  Duration leave = std::chrono::milliseconds(500);  ///< from the Goodbye to the cut
};

/// With fewer descriptors a node cannot carry its own services and a few links.
constexpr std::size_t kLeastDescriptors = 256;
/// Enough for the limits above and for links to a thousand nodes.
constexpr std::size_t kGoodDescriptors = 12288;
/// The limits for this many descriptors (RLIMIT_NOFILE): strangers get a quarter, never more than the limits above.
PendingConnectionLimits limits_for(std::size_t descriptors);

/// state    | event                        | next
/// ---------|------------------------------|------------------------------------------------------------
/// -        | accepted                     | unproven; the 129th of its source: that source is blocked
/// unproven | linked                       | linked
/// unproven | 4 s (expired)                | cut, counted as a failure of its source
/// unproven | leave                        | leaving: cut after 0.5 s, so that a Goodbye is read
/// linked   | leave                        | leaving
/// any      | gone                         | -; unproven: a failure of its source
/// The 513th failure of a source in 10 s blocks it: its unproven connections are cut, new ones never come up.
class PendingConnections {
 public:
  explicit PendingConnections(PendingConnectionLimits limits = {}) : limits_(limits) {}

  /// What has to be done since the last call.
  struct Orders {
    std::vector<PendingConnectionId> cut;
    std::vector<PendingConnectionId> expired;  ///< of these, those whose time to become a link is over
    std::vector<std::string> newly_blocked;
    bool filter_changed = false;  ///< blocked() or closed() has changed
  };

  PendingConnectionId accepted(const std::string& source, MonotonicTime now);
  void linked(PendingConnectionId id);
  void leave(PendingConnectionId id, MonotonicTime now);
  void gone(PendingConnectionId id, MonotonicTime now);
  void tick(MonotonicTime now);
  [[nodiscard]] std::optional<MonotonicTime> next_deadline() const;
  Orders take_orders();

  /// Is it open, and neither linked nor leaving?
  [[nodiscard]] bool undecided(PendingConnectionId id) const;
  [[nodiscard]] const std::map<std::string, MonotonicTime>& blocked() const { return blocked_; }
  /// Nobody's connection is accepted for now: there are too many unproven ones.
  [[nodiscard]] bool closed() const { return closed_; }
  [[nodiscard]] std::size_t unproven() const { return unproven_; }

 private:
  struct Entry {
    std::string source;
    bool linked = false;
    bool leaving = false;
    std::optional<MonotonicTime> cut_at;
  };
  struct Source {
    std::size_t open = 0;
    std::size_t failures = 0;
    MonotonicTime window_end;
  };

  Source* source_of(const std::string& name, MonotonicTime now);
  void count_out(const Entry& entry);
  void failed(const std::string& name, MonotonicTime now);
  void block(const std::string& name, MonotonicTime now);
  void set_closed(bool closed);

  PendingConnectionLimits limits_;
  PendingConnectionId last_ = 0;
  std::map<PendingConnectionId, Entry> entries_;
  std::set<std::pair<MonotonicTime, PendingConnectionId>> cuts_;
  std::map<std::string, Source> sources_;
  std::map<std::string, MonotonicTime> blocked_;  ///< source -> until when
  std::size_t unproven_ = 0;
  bool closed_ = false;
  std::optional<MonotonicTime> forget_at_;
  Orders orders_;
};

}  // namespace trb::router
