#include "services/scheduler/core/deferred_messages.hpp"

#include <algorithm>
#include <map>

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

std::string DeferredMessages::greediest(const std::string& first) const {
  std::map<std::string, std::size_t> counts;
  for (const Entry& entry : entries_) ++counts[entry.message.source];
  std::string out = first;
  for (const auto& [source, count] : counts) {
    if (count > counts[out]) out = source;
  }
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
  entries_.push_back({run, now + kPatience, message});
  if (entries_.size() <= kMax) return std::nullopt;
  const std::string gives_way = greediest(message.source);
  const auto newest = std::find_if(entries_.rbegin(), entries_.rend(),
                                   [&](const Entry& entry) { return entry.message.source == gives_way; });
  Inbound out = std::move(newest->message);
  entries_.erase(std::prev(newest.base()));
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
