#include "services/cloud-gateway/core/access/failure_table.hpp"

#include <algorithm>
#include <tuple>

namespace trb::gateway {
namespace {

/// 2^20 s is longer than any rule's longest wait.
constexpr std::uint32_t kMostDoublings = 20;

}  // namespace

Duration FailureTable::wait(std::string_view key, MonotonicTime now) const {
  const auto at = rows_.find(key);
  if (at == rows_.end()) return {};
  return std::max(Duration{0}, at->second.last + wait_after(at->second.failures) - now);
}

void FailureTable::count(std::string_view key, MonotonicTime now) {
  auto at = rows_.find(key);
  if (at == rows_.end()) {
    if (rows_.size() >= rule_.room) make_room(now);
    at = rows_.emplace(std::string(key), Row{}).first;
  } else if (now - at->second.last >= kForgetFailures) {
    at->second.failures = 0;
  }
  ++at->second.failures;
  at->second.last = now;
}

void FailureTable::take_back(std::string_view key) {
  const auto at = rows_.find(key);
  if (at == rows_.end()) return;
  if (--at->second.failures == 0) rows_.erase(at);
}

Duration FailureTable::wait_after(std::uint32_t failures) const {
  if (failures <= rule_.free) return {};
  const std::uint32_t doublings = std::min(failures - rule_.free - 1, kMostDoublings);
  return std::min<Duration>(rule_.most, std::chrono::seconds(1LL << doublings));
}

void FailureTable::make_room(MonotonicTime now) {
  std::erase_if(rows_, [&](const auto& row) { return now - row.second.last >= kForgetFailures; });
  if (rows_.size() < rule_.room) return;
  const auto weaker = [](const auto& a, const auto& b) {
    return std::tie(a.second.failures, a.second.last) < std::tie(b.second.failures, b.second.last);
  };
  rows_.erase(std::ranges::min_element(rows_, weaker));
}

}  // namespace trb::gateway
