#include "services/simulator/world/events.hpp"

#include <algorithm>
#include <utility>

namespace trb::world {

void Events::at(MonotonicTime time, What what) {
  if (free_.empty()) {
    free_.push_back(whats_.size());
    whats_.emplace_back();
  }
  const std::size_t place = free_.back();
  free_.pop_back();
  whats_[place] = std::move(what);
  heap_.push_back({std::max(time, now_), ++posted_, place});
  std::push_heap(heap_.begin(), heap_.end());
}

bool Events::step(MonotonicTime limit) {
  if (heap_.empty() || heap_.front().time > limit) {
    skip_to(limit);
    return false;
  }
  std::pop_heap(heap_.begin(), heap_.end());
  const Event event = heap_.back();
  heap_.pop_back();
  What what = std::move(whats_[event.place]);
  free_.push_back(event.place);
  skip_to(event.time);
  ++happened_;
  what();
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
