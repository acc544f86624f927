#include "services/router/core/counter_table.hpp"

namespace trb::router {

void CounterTable::count(std::string_view name, std::uint64_t by) {
  const auto at = counts_.find(name);
  if (at != counts_.end()) {
    at->second += by;
  } else if (counts_.size() < kMost) {
    counts_.emplace(name, by);
  }
}

void CounterTable::take_back(std::string_view name) {
  if (const auto at = counts_.find(name); at != counts_.end() && at->second > 0) --at->second;
}

std::uint64_t CounterTable::value(std::string_view name) const {
  const auto at = counts_.find(name);
  return at == counts_.end() ? 0 : at->second;
}

Counters CounterTable::table(const std::string& node) const {
  Counters out{node, "router", {}};
  for (const auto& [name, value] : counts_) out.values.push_back({name, value});
  return out;
}

}  // namespace trb::router
