// Virtual time: it passes from event to event. Of two at the same time the one that was posted first happens first.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <new>
#include <optional>
#include <type_traits>
#include <utility>
#include <vector>

#include "common/base/time.hpp"

namespace trb::world {

/// What happens at an event: a function without arguments, kept in place if it is small. Nearly all are, and a world
/// has millions of them.
class What {
 public:
  What() = default;
  template <class Is>
  requires(!std::is_same_v<std::decay_t<Is>, What>)
      What(Is&& is) {  // NOLINT(google-explicit-constructor, bugprone-forwarding-reference-overload): as std::function
    using Kept = std::decay_t<Is>;
    if constexpr (kFits<Kept>) {
      ::new (static_cast<void*>(place_)) Kept(std::forward<Is>(is));
      handling_ = &kHandling<Kept>;
    } else {
      *this = What([far = std::make_unique<Kept>(std::forward<Is>(is))] { (*far)(); });
    }
  }
  What(What&& other) noexcept { take(other); }
  What& operator=(What&& other) noexcept {
    if (this == &other) return *this;
    clear();
    take(other);
    return *this;
  }
  What(const What&) = delete;
  What& operator=(const What&) = delete;
  ~What() { clear(); }

  void operator()() { handling_->call(place_); }

 private:
  static constexpr std::size_t kSize = 72;  ///< room for the largest of the common events: a frame arrives
  struct Handling {
    void (*call)(void* at);
    void (*move)(void* to, void* from) noexcept;  ///< and destroys what was at `from`
    void (*destroy)(void* at) noexcept;
  };
  template <class Kept>
  static constexpr bool kFits = sizeof(Kept) <= kSize &&
                                alignof(Kept) <= alignof(void*) && std::is_nothrow_move_constructible_v<Kept>;
  template <class Kept>
  static Kept& kept(void* at) {
    return *std::launder(static_cast<Kept*>(at));
  }
  template <class Kept>
  static constexpr Handling kHandling{.call = [](void* at) { kept<Kept>(at)(); },
                                      .move =
                                          [](void* to, void* from) noexcept {
                                            ::new (to) Kept(std::move(kept<Kept>(from)));
                                            kept<Kept>(from).~Kept();
                                          },
                                      .destroy = [](void* at) noexcept { kept<Kept>(at).~Kept(); }};

  void take(What& other) noexcept {
    if (other.handling_ != nullptr) other.handling_->move(place_, other.place_);
    handling_ = std::exchange(other.handling_, nullptr);
  }
  void clear() noexcept {
    if (const Handling* before = std::exchange(handling_, nullptr)) before->destroy(place_);
  }

  const Handling* handling_ = nullptr;
  alignas(void*) unsigned char place_[kSize];
};

class Events {
 public:
  using What = world::What;

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
