// What a service has counted, by name: for `trb service counters` and the tests.
#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <string_view>

#include "common/base/lookup_table.hpp"
#include "proto/bodies/bus.hpp"

namespace trb {

class CounterTable {
 public:
  static constexpr std::size_t kMost = 1000;  ///< names; further ones are not counted

  CounterTable() = default;
  CounterTable(const CounterTable&) = delete;
  CounterTable& operator=(const CounterTable&) = delete;

  /// A name over Counter::kLongestName is counted by its beginning.
  void count(std::string_view name, std::uint64_t by = 1);
  /// Undoes a count: the event did not happen after all.
  void take_back(std::string_view name);
  [[nodiscard]] std::uint64_t value(std::string_view name) const;
  /// The answer to a request for the counters of this service.
  [[nodiscard]] Counters table(const std::string& node, const std::string& service) const;

 private:
  std::map<std::string, std::uint64_t, std::less<>> counts_;
  LookupTable<std::string_view, std::uint64_t> by_name_;  ///< the same rows
};

}  // namespace trb
