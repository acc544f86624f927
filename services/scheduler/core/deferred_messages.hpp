// Messages about runs that this node does not know yet: they wait for the definition, a short while and not many. Who
// has the most gives way, so that nobody takes the others' places.
#pragma once

#include <algorithm>
#include <optional>
#include <string>
#include <vector>

#include "common/actor/inbound.hpp"
#include "common/base/time.hpp"

namespace trb::scheduler {

class DeferredMessages {
 public:
  static constexpr std::size_t kMax = 64;
  static constexpr Duration kPatience = std::chrono::seconds(10);

  /// Keeps a message for `run`; one of the same sender, run and subtype takes the older one's place, because its owner
  /// resends. Returns the message that has no place: if all are taken the newest of the source that has the most, which
  /// may be this one.
  std::optional<Inbound> add(const std::string& run, const Inbound& message, MonotonicTime now);
  /// True if `source` has a message waiting for that run: only then was the definition requested from it.
  [[nodiscard]] bool waits(const std::string& run, const std::string& source) const;
  /// One of those that `source` has waiting for that run matches.
  template <class Match>
  [[nodiscard]] bool any(const std::string& run, const std::string& source, const Match& match) const {
    return std::ranges::any_of(entries_, [&](const Entry& entry) {
      return entry.run == run && entry.message.source == source && match(entry.message.body);
    });
  }
  /// Takes out all messages of a run, in order of arrival.
  std::vector<Inbound> take(const std::string& run);
  /// Takes out what `source` sent for a run: its definition was wrong.
  std::vector<Inbound> take(const std::string& run, const std::string& source);
  /// Takes out those that have waited too long.
  std::vector<Inbound> take_late(MonotonicTime now);
  [[nodiscard]] std::optional<MonotonicTime> next() const;

 private:
  struct Entry {
    std::string run;
    MonotonicTime until;
    Inbound message;
  };
  template <class Match>
  std::vector<Inbound> take_if(Match match);

  std::vector<Entry> entries_;
};

}  // namespace trb::scheduler
