#include "services/router/core/visitors.hpp"

#include <algorithm>
#include <utility>

namespace trb::router {

VisitorLimits limits_for(std::size_t descriptors) {
  constexpr std::size_t kOwn = 128;  // files, the bus, libzmq itself
  constexpr std::size_t kFewest = 32;
  VisitorLimits limits;
  const std::size_t rest = descriptors - std::min(descriptors, kOwn);
  limits.open = std::clamp(rest / 4, kFewest, limits.open);
  limits.open_from_one = std::max<std::size_t>(limits.open / 8, 16);
  return limits;
}

Visitors::Source* Visitors::source_of(const std::string& name, MonotonicTime now) {
  auto at = sources_.find(name);
  if (at == sources_.end()) {
    if (sources_.size() >= limits_.sources) return nullptr;
    at = sources_.emplace(name, Source{0, 0, now + limits_.window}).first;
    if (!forget_at_) forget_at_ = now + limits_.window;
  }
  if (now >= at->second.window_end) {
    at->second.failures = 0;
    at->second.window_end = now + limits_.window;
  }
  return &at->second;
}

VisitorId Visitors::accepted(const std::string& source, MonotonicTime now) {
  const VisitorId id = ++last_;
  Visitor& visitor = visitors_[id];
  visitor.source = source;
  visitor.cut_at = now + limits_.proof;
  cuts_.emplace(*visitor.cut_at, id);
  ++unproven_;
  Source* from = source_of(source, now);
  if (from != nullptr) ++from->open;
  if (blocked_.count(source) != 0) {
    orders_.cut.push_back(id);  // it was in the queue of the listening socket when its source was shut out
  } else if (from != nullptr && from->open > limits_.open_from_one) {
    block(source, now);
  }
  if (unproven_ >= limits_.open) set_closed(true);
  return id;
}

void Visitors::count_out(const Visitor& visitor) {
  if (visitor.linked) return;
  --unproven_;
  if (const auto at = sources_.find(visitor.source); at != sources_.end() && at->second.open > 0) --at->second.open;
  if (unproven_ <= limits_.open / 2) set_closed(false);
}

void Visitors::linked(VisitorId id) {
  const auto at = visitors_.find(id);
  if (at == visitors_.end() || at->second.linked || at->second.leaving) return;
  count_out(at->second);
  at->second.linked = true;
  cuts_.erase({*at->second.cut_at, id});
  at->second.cut_at.reset();
}

void Visitors::leave(VisitorId id, MonotonicTime now) {
  const auto at = visitors_.find(id);
  if (at == visitors_.end() || at->second.leaving) return;
  Visitor& visitor = at->second;
  visitor.leaving = true;
  if (visitor.cut_at) cuts_.erase({*visitor.cut_at, id});
  visitor.cut_at = now + limits_.leave;
  cuts_.emplace(*visitor.cut_at, id);
}

bool Visitors::undecided(VisitorId id) const {
  const auto at = visitors_.find(id);
  return at != visitors_.end() && !at->second.linked && !at->second.leaving;
}

void Visitors::gone(VisitorId id, MonotonicTime now) {
  const auto at = visitors_.find(id);
  if (at == visitors_.end()) return;
  const Visitor visitor = std::move(at->second);
  if (visitor.cut_at) cuts_.erase({*visitor.cut_at, id});
  visitors_.erase(at);
  count_out(visitor);
  if (!visitor.linked) failed(visitor.source, now);
}

void Visitors::failed(const std::string& name, MonotonicTime now) {
  Source* from = source_of(name, now);
  if (from == nullptr || ++from->failures <= limits_.failures_of_one || blocked_.count(name) != 0) return;
  block(name, now);
}

void Visitors::block(const std::string& name, MonotonicTime now) {
  if (blocked_.size() >= limits_.blocked) return;  // what all may have together still bounds it
  blocked_[name] = now + limits_.block;
  orders_.newly_blocked.push_back(name);
  orders_.filter_changed = true;
  for (const auto& [id, visitor] : visitors_) {
    if (visitor.source == name && !visitor.linked) orders_.cut.push_back(id);
  }
}

void Visitors::set_closed(bool closed) {
  if (closed_ == closed) return;
  closed_ = closed;
  orders_.filter_changed = true;
}

void Visitors::tick(MonotonicTime now) {
  while (!cuts_.empty() && cuts_.begin()->first <= now) {
    const VisitorId id = cuts_.begin()->second;
    cuts_.erase(cuts_.begin());
    // It stays in the books until libzmq says that it is gone; if that never comes, it is cut again.
    Visitor& visitor = visitors_.at(id);
    if (!visitor.leaving) orders_.expired.push_back(id);
    visitor.cut_at = now + limits_.window;
    cuts_.emplace(*visitor.cut_at, id);
    orders_.cut.push_back(id);
  }
  const bool freed = std::erase_if(blocked_, [&](const auto& row) { return row.second <= now; }) != 0;
  orders_.filter_changed = orders_.filter_changed || freed;
  if (!forget_at_ || now < *forget_at_) return;
  std::erase_if(sources_, [&](const auto& row) { return row.second.open == 0 && row.second.window_end <= now; });
  forget_at_ = sources_.empty() ? std::nullopt : std::optional(now + limits_.window);
}

std::optional<MonotonicTime> Visitors::next_deadline() const {
  std::optional<MonotonicTime> next = forget_at_;
  if (!cuts_.empty()) next = earlier(next, cuts_.begin()->first);
  for (const auto& [name, until] : blocked_) next = earlier(next, until);
  return next;
}

Visitors::Orders Visitors::take_orders() {
  return std::exchange(orders_, {});
}

}  // namespace trb::router
