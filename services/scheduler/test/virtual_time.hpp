// Time that passes only from event to event.
#pragma once

#include <algorithm>
#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <utility>

#include "common/base/time.hpp"

namespace trb::scheduler::test {

template <class Event>
class VirtualTime {
 public:
  [[nodiscard]] MonotonicTime now() const { return now_; }
  void pass_to(MonotonicTime time) { now_ = std::max(now_, time); }
  /// Numbers messages and events in the order in which they come to be.
  std::uint64_t next_number() { return ++count_; }

  /// It happens after `delay`; of two at the same time the one that was posted first.
  void post(Event event, Duration delay) { events_[{now_.ns + delay.count(), ++count_}] = std::move(event); }
  /// The next event whose time has come.
  std::optional<Event> take_due() {
    if (events_.empty() || events_.begin()->first.first > now_.ns) return std::nullopt;
    Event event = std::move(events_.begin()->second);
    events_.erase(events_.begin());
    return event;
  }

  /// When something is due on that node without an event.
  void set_deadline(const std::string& node, std::optional<MonotonicTime> at) { deadlines_[node] = at; }
  [[nodiscard]] bool is_due(const std::string& node) const {
    const auto at = deadlines_.at(node);
    return at && *at <= now_;
  }
  /// Of everything that is to come.
  [[nodiscard]] std::optional<MonotonicTime> next() const {
    std::optional<MonotonicTime> out;
    if (!events_.empty()) out = MonotonicTime{events_.begin()->first.first};
    for (const auto& [node, at] : deadlines_) out = earlier(out, at);
    return out;
  }

 private:
  MonotonicTime now_{1'000'000'000};
  std::map<std::pair<std::int64_t, std::uint64_t>, Event> events_;
  std::map<std::string, std::optional<MonotonicTime>> deadlines_;
  std::uint64_t count_ = 0;
};

}  // namespace trb::scheduler::test
