// Virtual time: it passes from event to event. Of two at the same time the one that was posted first happens first.
#pragma once

#include <algorithm>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <vector>

#include "common/base/time.hpp"

namespace trb::world {

class Events {
 public:
  using What = std::function<void()>;

  [[nodiscard]] MonotonicTime now() const { return now_; }
  /// How long the world has existed.
  [[nodiscard]] double seconds_passed() const { return to_seconds(now_ - kBegin); }
  /// How many events have happened.
  [[nodiscard]] std::uint64_t count() const { return happened_; }

  void at(MonotonicTime time, What what);
  void after(Duration delay, What what) { at(now_ + delay, std::move(what)); }
  /// Happens only if `owner` is still there.
  template <class Owner, class Step>
  void after(Duration delay, const std::shared_ptr<Owner>& owner, Step step) {
    after(delay, [owner = std::weak_ptr<Owner>(owner), step = std::move(step)]() mutable {
      if (!owner.expired()) step();
    });
  }

  /// The next event happens, if it is due by `limit`; otherwise time passes to there.
  bool step(MonotonicTime limit);
  /// It is that late now, and nothing has happened meanwhile: what is overdue happens at the next steps.
  void skip_to(MonotonicTime time) { now_ = std::max(now_, time); }

 private:
  static constexpr MonotonicTime kBegin{1'000'000'000};
  struct Event {
    MonotonicTime time;
    std::uint64_t number = 0;
    std::size_t place = 0;  ///< of its What: moving a function about the heap would cost more than the heap
    bool operator<(const Event& other) const { return time != other.time ? time > other.time : number > other.number; }
  };

  MonotonicTime now_ = kBegin;
  std::uint64_t posted_ = 0, happened_ = 0;
  std::vector<Event> heap_;
  std::vector<What> whats_;
  std::vector<std::size_t> free_;
};

/// A deadline that moves: its owner is woken at the one that was set last.
class Timer {
 public:
  Timer(Events& events, Events::What wake)
      : events_(events), state_(std::make_shared<State>(State{std::move(wake), {}, {}})) {}
  void set(std::optional<MonotonicTime> at);

 private:
  struct State {
    Events::What wake;
    std::optional<MonotonicTime> due;
    std::optional<MonotonicTime> posted;  ///< the earliest event that looks at it
  };
  static void post(Events& events, const std::shared_ptr<State>& state, MonotonicTime at);

  Events& events_;
  std::shared_ptr<State> state_;
};

}  // namespace trb::world
