// The streams of values that clients watch: requested from each sensor's node, renewed, and ended.
#pragma once

#include <map>
#include <optional>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "common/actor/outbox.hpp"
#include "services/cloud-gateway/core/live/row_book.hpp"

namespace trb::gateway {

struct SensorId {
  std::string node;
  std::string name;
  auto operator<=>(const SensorId&) const = default;
};

/// -       | wanted                                        | waiting
/// waiting | its node is reached and has it: order (10 s)  | running
/// waiting | else: looked at again after 0.5 s             | waiting
/// running | every 3 s: order, which renews it             | running; waiting, if its node is away or lost it (**)
/// running | not wanted any more: order of 0 s             | -
/// any     | the router has forgotten this service (*)     | waiting (**)
/// (*) The node knows a stream by the connection that ordered it: the old one ends with its lease.
/// (**) The next order has a new number, because the node may count from 1 again; it ends the old stream.
class SensorStreams {
 public:
  static constexpr std::size_t kMaxStreams = 256;  ///< what one node's sensor-bus gives in all
  static constexpr double kEvery_s = 0.1;          ///< as often as a client gets a frame
  static constexpr double kLease_s = 10;
  static constexpr Duration kRenew = std::chrono::seconds(3);
  static constexpr Duration kLook = std::chrono::milliseconds(500);

  /// The book must outlive it.
  explicit SensorStreams(const RowBook& book) : book_(book) {}

  void on_welcome(Now now);
  /// These sensors and no others. Returns those that were wanted until now.
  std::vector<SensorId> want(const std::set<SensorId>& wanted, Now now);
  void tick(Now now, Outbox& out);
  [[nodiscard]] bool has(const SensorId& sensor) const { return streams_.contains(sensor); }
  [[nodiscard]] std::optional<MonotonicTime> next_deadline() const;

 private:
  struct Stream {
    std::uint64_t number = 0;  ///< its values carry it
    MonotonicTime at;          ///< of the next order or look
    bool is_ordered = false;
    bool is_doubtful = false;  ///< its node was away since the order
  };
  void drive(const SensorId& sensor, Stream& stream, Now now, Outbox& out);
  [[nodiscard]] bool may_order(const SensorId& sensor) const;

  const RowBook& book_;
  std::map<SensorId, Stream> streams_;
  std::vector<std::pair<SensorId, std::uint64_t>> ended_;  ///< to be told to their nodes
  std::uint64_t last_ = 0;
};

}  // namespace trb::gateway
