#include "services/simulator/world/events.hpp"

#include <algorithm>

namespace trb::world {

void Events::at(MonotonicTime time, What what) {
  heap_.push_back({std::max(time, now_), ++posted_, std::move(what)});
  std::push_heap(heap_.begin(), heap_.end());
}

bool Events::step(MonotonicTime limit) {
  if (heap_.empty() || heap_.front().time > limit) {
    now_ = std::max(now_, limit);
    return false;
  }
  std::pop_heap(heap_.begin(), heap_.end());
  const Event event = std::move(heap_.back());
  heap_.pop_back();
  now_ = event.time;
  ++happened_;
  event.what();
  return true;
}

void Timer::set(std::optional<MonotonicTime> at) {
  state_->due = at;
  if (at && (!state_->posted || *at < *state_->posted)) post(events_, state_, *at);
}

void Timer::post(Events& events, const std::shared_ptr<State>& state, MonotonicTime at) {
  state->posted = at;
  events.at(at, [&events, at, weak = std::weak_ptr<State>(state)] {
    const auto here = weak.lock();
    if (!here || here->posted != at) return;
    here->posted.reset();
    if (!here->due) return;
    if (*here->due > events.now()) return post(events, here, *here->due);
    here->due.reset();
    here->wake();
  });
}

}  // namespace trb::world
