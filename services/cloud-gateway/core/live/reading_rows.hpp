// Rows with the last value of each watched sensor.
#pragma once

#include <map>
#include <optional>
#include <set>
#include <string>

#include "common/actor/outbox.hpp"
#include "services/cloud-gateway/core/live/row_book.hpp"

namespace trb::gateway {

class ReadingRows {
 public:
  static constexpr Duration kShortest = std::chrono::seconds(3);  ///< shortest time until a value is late
  static constexpr Duration kLongest = std::chrono::hours(1);

  explicit ReadingRows(RowBook& book) : book_(book) {}

  /// The sensor must be known from its node. `live`: the node's state.
  void take(const std::string& node, const SensorReading& reading, Live live, Now now, Outbox& out);
  /// A value older than three of its periods becomes late. Its count is forgotten: its node may have made the watch
  /// anew, and counts from 1 again, by a clock that was set back.
  void tick(Now now);
  [[nodiscard]] std::optional<MonotonicTime> next_deadline() const;

 private:
  struct Seen {
    std::uint64_t watch = 0;
    std::uint64_t count = 0;
    std::int64_t time = 0;  ///< of the measurement, by its node's clock: UTC, ns
    MonotonicTime at;
    MonotonicTime due;
  };
  void expect_next(const RowKey& key, Seen& seen, Now now);

  RowBook& book_;
  std::map<RowKey, Seen> seen_;
  std::set<std::pair<MonotonicTime, RowKey>> due_;
};

}  // namespace trb::gateway
