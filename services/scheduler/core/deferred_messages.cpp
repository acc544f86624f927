#include "services/scheduler/core/deferred_messages.hpp"

#include <algorithm>

#include "common/base/gives_way.hpp"

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

std::optional<Inbound> DeferredMessages::add(const std::string& run, const Inbound& message, MonotonicTime now) {
  const auto same = std::find_if(entries_.begin(), entries_.end(), [&](const Entry& entry) {
    return entry.run == run && entry.message.source == message.source &&
           entry.message.body.kind() == message.body.kind();
  });
  if (same != entries_.end()) {
    *same = {run, now + kPatience, message};
    return std::nullopt;
  }
  std::optional<Inbound> out;
  if (entries_.size() >= kMax) {
    const auto source_of = [](const Entry& entry) { return entry.message.source; };
    const std::string source = gives_way(entries_, message.source, source_of);
    if (source == message.source) return message;
    const auto newest = std::find_if(entries_.rbegin(), entries_.rend(),
                                     [&](const Entry& entry) { return entry.message.source == source; });
    out = std::move(newest->message);
    entries_.erase(std::prev(newest.base()));
  }
  entries_.push_back({run, now + kPatience, message});
  return out;
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
