// The fleet's history, as the database keeps it: the core itself keeps none.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "services/resilience/core/fleet.hpp"

namespace trb::resilience {

class HistoryReader {
 public:
  HistoryReader() = default;
  HistoryReader(const HistoryReader&) = delete;
  HistoryReader& operator=(const HistoryReader&) = delete;
  virtual ~HistoryReader() = default;

  /// Newest first, `most` at most; of all robots if none is named.
  [[nodiscard]] virtual Result<std::vector<HistoryEntry>> history(const std::string& robot, std::uint32_t most) = 0;
};

}  // namespace trb::resilience
