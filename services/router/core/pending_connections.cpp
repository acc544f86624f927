#include "services/router/core/pending_connections.hpp"

#include <algorithm>
#include <utility>

namespace trb::router {

PendingConnectionLimits limits_for(std::size_t descriptors) {
  constexpr std::size_t kOwn = 128;  // files, the bus, libzmq itself
  constexpr std::size_t kFewest = 32;
  PendingConnectionLimits limits;
  const std::size_t rest = descriptors - std::min(descriptors, kOwn);
  limits.open = std::clamp(rest / 4, kFewest, limits.open);
  limits.open_from_one = std::max<std::size_t>(limits.open / 8, 16);
  return limits;
}

PendingConnections::Source* PendingConnections::source_of(const std::string& name, MonotonicTime now) {
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

PendingConnectionId PendingConnections::accepted(const std::string& source, MonotonicTime now) {
  const PendingConnectionId id = ++last_;
  Entry& entry = entries_[id];
  entry.source = source;
  entry.cut_at = now + limits_.proof;
  cuts_.emplace(*entry.cut_at, id);
  ++unproven_;
  Source* from = source_of(source, now);
  if (from != nullptr) ++from->open;
  if (blocked_.count(source) != 0) {
    orders_.cut.push_back(id);  // it waited in the accept queue when its source was blocked
  } else if (from != nullptr && from->open > limits_.open_from_one) {
    block(source, now);
  }
  if (unproven_ >= limits_.open) set_closed(true);
  return id;
}

void PendingConnections::count_out(const Entry& entry) {
  if (entry.linked) return;
  --unproven_;
  if (const auto at = sources_.find(entry.source); at != sources_.end() && at->second.open > 0) --at->second.open;
  if (unproven_ <= limits_.open / 2) set_closed(false);
}

void PendingConnections::linked(PendingConnectionId id) {
  const auto at = entries_.find(id);
  if (at == entries_.end() || at->second.linked || at->second.leaving) return;
  count_out(at->second);
  at->second.linked = true;
  cuts_.erase({*at->second.cut_at, id});
  at->second.cut_at.reset();
}

void PendingConnections::leave(PendingConnectionId id, MonotonicTime now) {
  const auto at = entries_.find(id);
  if (at == entries_.end() || at->second.leaving) return;
  Entry& entry = at->second;
  entry.leaving = true;
  if (entry.cut_at) cuts_.erase({*entry.cut_at, id});
  entry.cut_at = now + limits_.leave;
  cuts_.emplace(*entry.cut_at, id);
}

bool PendingConnections::undecided(PendingConnectionId id) const {
  const auto at = entries_.find(id);
  return at != entries_.end() && !at->second.linked && !at->second.leaving;
}

void PendingConnections::gone(PendingConnectionId id, MonotonicTime now) {
  const auto at = entries_.find(id);
  if (at == entries_.end()) return;
  const Entry entry = std::move(at->second);
  if (entry.cut_at) cuts_.erase({*entry.cut_at, id});
  entries_.erase(at);
  count_out(entry);
  if (!entry.linked) failed(entry.source, now);
}

void PendingConnections::failed(const std::string& name, MonotonicTime now) {
  Source* from = source_of(name, now);
  if (from == nullptr || ++from->failures <= limits_.failures_of_one || blocked_.count(name) != 0) return;
  block(name, now);
}

void PendingConnections::block(const std::string& name, MonotonicTime now) {
  if (blocked_.size() >= limits_.blocked) return;  // the limit of all connections still holds
  blocked_[name] = now + limits_.block;
  orders_.newly_blocked.push_back(name);
  orders_.filter_changed = true;
  for (const auto& [id, entry] : entries_) {
    if (entry.source == name && !entry.linked) orders_.cut.push_back(id);
  }
}

void PendingConnections::set_closed(bool closed) {
  if (closed_ == closed) return;
  closed_ = closed;
  orders_.filter_changed = true;
}

void PendingConnections::tick(MonotonicTime now) {
  while (!cuts_.empty() && cuts_.begin()->first <= now) {
    const PendingConnectionId id = cuts_.begin()->second;
    cuts_.erase(cuts_.begin());
    // It stays in the table until libzmq reports its end; if that never comes, it is cut again.
    Entry& entry = entries_.at(id);
    if (!entry.leaving) orders_.expired.push_back(id);
    entry.cut_at = now + limits_.window;
    cuts_.emplace(*entry.cut_at, id);
    orders_.cut.push_back(id);
  }
  const bool freed = std::erase_if(blocked_, [&](const auto& row) { return row.second <= now; }) != 0;
  orders_.filter_changed = orders_.filter_changed || freed;
  if (!forget_at_ || now < *forget_at_) return;
  std::erase_if(sources_, [&](const auto& row) { return row.second.open == 0 && row.second.window_end <= now; });
  forget_at_ = sources_.empty() ? std::nullopt : std::optional(now + limits_.window);
}

std::optional<MonotonicTime> PendingConnections::next_deadline() const {
  std::optional<MonotonicTime> next = forget_at_;
  if (!cuts_.empty()) next = earlier(next, cuts_.begin()->first);
  for (const auto& [name, until] : blocked_) next = earlier(next, until);
  return next;
}

PendingConnections::Orders PendingConnections::take_orders() {
  return std::exchange(orders_, {});
}

}  // namespace trb::router
