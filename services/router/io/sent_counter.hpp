// The counters "sent.SUBTYPE".
#pragma once

#include <map>
#include <string>
#include <string_view>

#include "common/actor/counter_table.hpp"

namespace trb::router {

/// Counts what services and the router itself send, by subtype: 500 subtypes at most, so that nobody fills the table
/// with names.
class SentCounter {
 public:
  explicit SentCounter(CounterTable& counters) : counters_(counters) {}
  void count(std::string_view subtype);

 private:
  CounterTable& counters_;
  std::map<std::string, std::string, std::less<>> names_;  ///< subtype -> "sent.SUBTYPE", made once
};

}  // namespace trb::router
