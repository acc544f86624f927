#include "common/actor/counter_table.hpp"

#include "proto/value.hpp"

namespace trb {

static_assert(CounterTable::kMost <= Counters::kMost);

void CounterTable::count(std::string_view name, std::uint64_t by) {
  if (name.size() > Counter::kLongestName) return count(cut_utf8(name, Counter::kLongestName), by);
  if (std::uint64_t* count = by_name_.find(name)) {
    *count += by;
  } else if (counts_.size() < kMost) {
    const auto at = counts_.emplace(name, by).first;
    by_name_.set(at->first, at->second);
  }
}

void CounterTable::take_back(std::string_view name) {
  if (std::uint64_t* count = by_name_.find(name); count != nullptr && *count > 0) --*count;
}

std::uint64_t CounterTable::value(std::string_view name) const {
  const auto at = counts_.find(name);
  return at == counts_.end() ? 0 : at->second;
}

Counters CounterTable::table(const std::string& node, const std::string& service) const {
  Counters out{node, service, {}};
  for (const auto& [name, value] : counts_) out.values.push_back({name, value});
  return out;
}

}  // namespace trb
