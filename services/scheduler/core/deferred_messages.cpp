#include "services/scheduler/core/deferred_messages.hpp"

#include <algorithm>

namespace trb::scheduler {

template <class Match>
std::vector<Inbound> DeferredMessages::take_if(Match match) {
  std::vector<Inbound> out;
  std::erase_if(entries_, [&](Entry& entry) {
    if (!match(entry)) return false;
    out.push_back(std::move(entry.message));
    return true;
  });
  return out;
}

bool DeferredMessages::add(const std::string& run, const Inbound& message, MonotonicTime now) {
  const auto same = std::find_if(entries_.begin(), entries_.end(), [&](const Entry& entry) {
    return entry.run == run && entry.message.source == message.source &&
           entry.message.body.kind() == message.body.kind();
  });
  if (same != entries_.end()) {
    *same = {run, now + kPatience, message};
    return true;
  }
  if (entries_.size() >= kMax) return false;
  entries_.push_back({run, now + kPatience, message});
  return true;
}

bool DeferredMessages::waits(const std::string& run, const std::string& source) const {
  return std::any_of(entries_.begin(), entries_.end(),
                     [&](const Entry& entry) { return entry.run == run && entry.message.source == source; });
}

std::vector<Inbound> DeferredMessages::take(const std::string& run) {
  return take_if([&](const Entry& entry) { return entry.run == run; });
}

std::vector<Inbound> DeferredMessages::take(const std::string& run, const std::string& source) {
  return take_if([&](const Entry& entry) { return entry.run == run && entry.message.source == source; });
}

std::vector<Inbound> DeferredMessages::take_late(MonotonicTime now) {
  return take_if([&](const Entry& entry) { return entry.until <= now; });
}

std::optional<MonotonicTime> DeferredMessages::next() const {
  std::optional<MonotonicTime> out;
  for (const Entry& entry : entries_) out = earlier(out, entry.until);
  return out;
}

}  // namespace trb::scheduler
