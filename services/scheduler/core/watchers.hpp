// Who watches the runs, and which version each watcher has received last.
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "common/actor/outbox.hpp"
#include "common/base/time.hpp"

namespace trb::scheduler {

class Watchers {
 public:
  static constexpr std::size_t kMax = 8;
  static constexpr double kLongest_s = 60;

  /// A new watch, or (of the same requester and service) one in the place of the older. If there is no place, who has
  /// the most gives way, and anybody else to the own node. Error: queue_full, bad_value.
  Status add(const Inbound& from, double lease_s, Now now);
  void forget(MonotonicTime now);
  [[nodiscard]] bool empty() const { return watchers_.empty(); }
  /// Notifies those that have not got this version of the run. `summary` is made only if somebody has to be.
  template <class Summary>
  void notify(const std::string& run, std::uint64_t version, const Summary& summary, Outbox& out) {
    for (Watcher& watcher : watchers_) {
      const auto [last, is_new] = watcher.sent.try_emplace(run, version);
      if (!is_new && last->second == version) continue;
      last->second = version;
      out.sends.push_back({.target = watcher.source, .reply_to = watcher.id, .body = RunChanged{summary()}});
    }
  }
  /// The run leaves: its watchers are notified a last time.
  void leave(const RunSummary& last, Outbox& out);
  /// What the answer to a watch contained.
  void note_sent(const Inbound& from, const std::string& run, std::uint64_t version);

 private:
  struct Watcher {
    std::string source;
    std::uint64_t id = 0;
    MonotonicTime until;
    std::map<std::string, std::uint64_t> sent;
  };
  bool make_room(const Inbound& from);

  std::vector<Watcher> watchers_;
};

}  // namespace trb::scheduler
